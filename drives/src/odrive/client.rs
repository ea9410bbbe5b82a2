//! Commands to such a drive and decoding of its answers.
//!
//! ```
//! use drives::odrive::{Firmware, client, payload::InputPosition, payload::Milli};
//! use drives::odrive::{Command, Report};
//!
//! let input = InputPosition { position: 0.6, velocity: Milli(0.0), torque: Milli(0.0) };
//! let frame = client::command(Firmware::V0_6, 1, &Command::SetInputPosition(input)).unwrap();
//! assert_eq!(frame.raw_id(), 0x2c);
//! assert_eq!(client::request(1, 0x09).unwrap().raw_id(), 0x29);
//! ```

use super::Firmware;
use super::message::{Command, Report, identifier};
use super::parameters::Value;
use super::payload::ParameterAccess;
use crate::frame::{Frame, standard};

/// Frame of a command; `None` if the firmware line does not have the command.
pub fn command(firmware: Firmware, node_id: u8, command: &Command) -> Option<Frame> {
    command.encode(firmware, node_id)
}

/// Request for a report by the command's identifier.
pub fn request(node_id: u8, command: u8) -> Option<Frame> {
    Frame::remote(standard(identifier(node_id, command)), 8)
}

/// Command that reads a parameter (firmware 0.6).
pub fn read_parameter(endpoint: u16) -> Command {
    Command::Parameter(ParameterAccess { opcode: 0, endpoint, value: [0; 4] })
}

/// Command that writes a parameter (firmware 0.6).
pub fn write_parameter(endpoint: u16, value: Value) -> Command {
    Command::Parameter(ParameterAccess { opcode: 1, endpoint, value: value.to_bytes() })
}

/// Node and report of a frame; `None` for any other frame.
pub fn decode(firmware: Firmware, frame: &Frame) -> Option<(u8, Report)> {
    Report::decode(firmware, frame)
}

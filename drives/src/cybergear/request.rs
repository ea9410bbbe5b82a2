//! Frames to a drive, in both directions.

use super::model::Model;
use super::wire::{Header, join, kind, split};
use crate::frame::Frame;

/// First bytes of frames that change the communication.
const SIGNATURE: [u8; 6] = [1, 2, 3, 4, 5, 6];

/// Set-point of the operation mode at the output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Operation {
    /// Angle [rad].
    pub angle: f32,
    /// Speed [rad/s].
    pub speed: f32,
    /// Stiffness [N m/rad].
    pub kp: f32,
    /// Damping [N m s/rad].
    pub kd: f32,
    /// Torque [N m].
    pub torque: f32,
}

/// Command to a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Asks for address and unique identifier.
    Identify,
    /// Sets the set-point of the operation mode.
    Operate(Operation),
    /// Enables the drive in its run mode.
    Enable,
    /// Stops the drive; clears a fault if true.
    Stop(bool),
    /// Calibrates the encoder.
    Calibrate,
    /// Makes the present angle the zero.
    SetZero,
    /// Gives the drive another address.
    SetAddress(u8),
    /// Reads the parameter at an index.
    Read(u16),
    /// Writes the parameter at an index.
    Write(u16, [u8; 4]),
    /// Saves the configuration; RobStride only.
    Save,
    /// Sets the bit rate at the next power-up: 1 to 4 for 1000, 500, 250, 125 kbit/s.
    SetRate(u8),
    /// Turns reports on or off; RobStride only.
    Report(bool),
    /// Sets the protocol at the next power-up; RobStride only.
    SetProtocol(u8),
}

/// Command with its addresses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Address of the host; the operation frame has none.
    pub host: Option<u8>,
    /// Address of the drive.
    pub drive: u8,
    /// Command.
    pub command: Command,
}

impl Request {
    /// Frame for a model; `None` if the model does not have the command.
    pub fn encode(&self, model: Model) -> Option<Frame> {
        let is_robstride = model.is_robstride();
        let mut data = u16::from(self.host.unwrap_or_default());
        let mut bytes = [0; 8];
        let kind = match self.command {
            Command::Identify => kind::IDENTIFY,
            Command::Operate(operation) => {
                (data, bytes) = operation.encode(model);
                kind::OPERATION
            }
            Command::Enable => kind::ENABLE,
            Command::Stop(clears) => {
                bytes[0] = clears.into();
                kind::STOP
            }
            Command::Calibrate => kind::CALIBRATE,
            Command::SetZero => {
                bytes[0] = 1;
                kind::SET_ZERO
            }
            Command::SetAddress(address) => {
                data |= u16::from(address) << 8;
                bytes[0] = 1;
                kind::SET_ADDRESS
            }
            Command::Read(index) => {
                bytes = indexed(index, [0; 4]);
                kind::READ
            }
            Command::Write(index, value) => {
                bytes = indexed(index, value);
                kind::WRITE
            }
            Command::Save if is_robstride => {
                bytes = [1, 2, 3, 4, 5, 6, 7, 8];
                kind::RATE_OR_SAVE
            }
            Command::SetRate(code) if is_robstride => {
                bytes = signed(code);
                kind::RATE
            }
            Command::SetRate(code) => {
                bytes[0] = code;
                kind::RATE_OR_SAVE
            }
            Command::Report(is_on) if is_robstride => {
                bytes = signed(is_on.into());
                kind::REPORT
            }
            Command::SetProtocol(code) if is_robstride => {
                bytes = signed(code);
                kind::PROTOCOL
            }
            Command::Save | Command::Report(_) | Command::SetProtocol(_) => return None,
        };
        Header { kind, data, target: self.drive }.frame(&bytes)
    }

    /// Command in a frame; `None` for all other frames.
    pub fn decode(model: Model, frame: &Frame) -> Option<Self> {
        let header = Header::read(frame)?;
        let is_robstride = model.is_robstride();
        let first = frame.data().first().copied();
        let signed =
            || frame.bytes().and_then(|[a, b, c, d, e, f, code]| ([a, b, c, d, e, f] == SIGNATURE).then_some(code));
        let command = match header.kind {
            kind::IDENTIFY => Command::Identify,
            kind::OPERATION => Command::Operate(Operation::decode(model, header.data, frame.bytes()?)),
            kind::ENABLE => Command::Enable,
            kind::STOP => Command::Stop(first == Some(1)),
            kind::CALIBRATE => Command::Calibrate,
            kind::SET_ZERO if first == Some(1) => Command::SetZero,
            kind::SET_ADDRESS => Command::SetAddress((header.data >> 8) as u8),
            kind::READ => Command::Read(u16::from_le_bytes(frame.bytes()?)),
            kind::WRITE => {
                let [low, high, _, _, value @ ..] = frame.bytes::<8>()?;
                Command::Write(u16::from_le_bytes([low, high]), value)
            }
            kind::RATE_OR_SAVE if is_robstride => Command::Save,
            kind::RATE_OR_SAVE => Command::SetRate(first?),
            kind::RATE if is_robstride => Command::SetRate(signed()?),
            kind::REPORT if is_robstride => Command::Report(signed()? == 1),
            kind::PROTOCOL if is_robstride => Command::SetProtocol(signed()?),
            _ => return None,
        };
        let host = (header.kind != kind::OPERATION).then_some(header.data as u8);
        Some(Self { host, drive: header.target, command })
    }
}

impl Operation {
    /// Data of the identifier and bytes.
    fn encode(&self, model: Model) -> (u16, [u8; 8]) {
        let sheet = model.sheet();
        let numbers = [
            sheet.angle.encode(self.angle),
            sheet.speed.encode(self.speed),
            sheet.kp.encode(self.kp),
            sheet.kd.encode(self.kd),
        ];
        (sheet.torque.encode(self.torque), join(numbers))
    }

    fn decode(model: Model, torque: u16, bytes: [u8; 8]) -> Self {
        let (sheet, [angle, speed, kp, kd]) = (model.sheet(), split(bytes));
        Self {
            angle: sheet.angle.decode(angle),
            speed: sheet.speed.decode(speed),
            kp: sheet.kp.decode(kp),
            kd: sheet.kd.decode(kd),
            torque: sheet.torque.decode(torque),
        }
    }
}

/// Bytes of an index and a value.
pub(super) fn indexed(index: u16, value: [u8; 4]) -> [u8; 8] {
    let ([low, high], [a, b, c, d]) = (index.to_le_bytes(), value);
    [low, high, 0, 0, a, b, c, d]
}

fn signed(code: u8) -> [u8; 8] {
    let [a, b, c, d, e, f] = SIGNATURE;
    [a, b, c, d, e, f, code, 0]
}

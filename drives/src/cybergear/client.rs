//! Host on the bus: frames that command a drive, and its answers.
//!
//! ```
//! use drives::cybergear::client::Client;
//! use drives::cybergear::{Model, Parameter, Value};
//!
//! let client = Client { model: Model::RobStride04, host: 0xFD, drive: 1 };
//! let frame = client.read(Parameter::ChasuAngleOut).unwrap();
//! assert_eq!(frame.raw_id(), 0x1100_FD01);
//! assert_eq!(frame.data(), [0x34, 0x30, 0, 0, 0, 0, 0, 0]);
//! assert_eq!(client.write(Parameter::MechPos, Value::U8(1)), None);
//! ```

use super::answer::Answer;
use super::model::Model;
use super::parameter::{Parameter, Value};
use super::request::{Command, Request};
use crate::frame::Frame;

/// Connection of a host to one drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Client {
    /// Model of the drive.
    pub model: Model,
    /// Address of the host.
    pub host: u8,
    /// Address of the drive.
    pub drive: u8,
}

impl Client {
    /// Frame of a command; `None` if the model does not have it.
    pub fn command(&self, command: Command) -> Option<Frame> {
        let host = (!matches!(command, Command::Operate(_))).then_some(self.host);
        Request { host, drive: self.drive, command }.encode(self.model)
    }

    /// Frame that reads a parameter; `None` if the model does not have it.
    pub fn read(&self, parameter: Parameter) -> Option<Frame> {
        self.command(Command::Read(self.model.index(parameter)?))
    }

    /// Frame that writes a parameter; `None` if the model does not have it or the value is of another kind.
    pub fn write(&self, parameter: Parameter, value: Value) -> Option<Frame> {
        let bytes = value.to_bytes();
        let is_of_kind = parameter.kind() == value.kind();
        self.command(Command::Write(self.model.index(parameter)?, bytes)).filter(|_| is_of_kind)
    }

    /// Answer of this drive in a frame; `None` for other frames and frames for other hosts.
    pub fn answer(&self, frame: &Frame) -> Option<Answer> {
        let answer = Answer::decode(self.model, frame)?;
        let (drive, host) = match answer {
            Answer::Device { drive, .. } => (drive, self.host),
            Answer::Feedback { drive, host, .. }
            | Answer::Report { drive, host, .. }
            | Answer::Parameter { drive, host, .. }
            | Answer::Fault { drive, host, .. }
            | Answer::Calibrated { drive, host, .. } => (drive, host),
        };
        ((drive, host) == (self.drive, self.host)).then_some(answer)
    }

    /// Parameter and value of an answer to a read; `None` for other answers and failures.
    pub fn value(&self, answer: &Answer) -> Option<(Parameter, Value)> {
        let Answer::Parameter { index, value: Some(bytes), .. } = answer else {
            return None;
        };
        let parameter = self.model.parameter(*index)?;
        Some((parameter, Value::from_bytes(parameter.kind(), *bytes)))
    }
}

//! Commander of a drive: encodes each command and decodes each answer.

use super::command::{Motion, Order};
use super::feedback::Feedback;
use super::mit::Ranges;
use super::parameter::{self, Parameter, Purpose};
use super::register::{Register, Value};
use crate::frame::{Frame, standard};

/// Drive as its commander knows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Client {
    /// Identifier of the drive.
    pub id: u16,
    /// Identifier of the drive's feedback frames and answers.
    pub feedback_id: u16,
    /// Ranges of the fields in frames, as the drive has them.
    pub ranges: Ranges,
}

/// Answer of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// Feedback frame.
    Feedback(Feedback),
    /// Value of a register that was read.
    Read(Register, Value),
    /// Value of a register that was written.
    Written(Register, Value),
    /// Registers are stored.
    Stored,
}

impl Client {
    /// Order to the drive's state.
    pub fn order(&self, order: Order) -> Option<Frame> {
        Frame::classic(standard(self.id), &order.encode())
    }

    /// Command of motion. The drive ignores it unless it is in the command's control mode.
    pub fn motion(&self, motion: &Motion) -> Option<Frame> {
        Frame::classic(standard(self.id.saturating_add(motion.mode().offset())), &motion.encode(&self.ranges))
    }

    /// Request for a feedback frame.
    pub fn refresh(&self) -> Option<Frame> {
        self.parameter(Purpose::Refresh, 0, [0; 4])
    }

    /// Request for the value of a register.
    pub fn read(&self, register: Register) -> Option<Frame> {
        self.parameter(Purpose::Read, register.address(), [0; 4])
    }

    /// Order to write a register.
    pub fn write(&self, register: Register, value: Value) -> Option<Frame> {
        self.parameter(Purpose::Write, register.address(), value.to_bytes())
    }

    /// Order to store all registers, for a disabled drive.
    pub fn store(&self) -> Option<Frame> {
        self.parameter(Purpose::Store, parameter::STORE_ALL, [0; 4])
    }

    fn parameter(&self, purpose: Purpose, address: u8, value: [u8; 4]) -> Option<Frame> {
        let request = Parameter { id: self.id, purpose, address, value };
        Frame::classic(standard(parameter::ID), &request.encode())
    }

    /// Answer in a frame; `None` for a frame of another drive. Feedback of a disabled drive that stands within a few
    /// hundredths of a radian of the lower end of the position range can look like the answer to a parameter frame.
    pub fn decode(&self, frame: &Frame) -> Option<Answer> {
        if frame.standard_id() != Some(self.feedback_id) {
            return None;
        }
        let data: [u8; 8] = frame.bytes()?;
        let parameter = Parameter::decode(&data).filter(|parameter| parameter.id == self.id);
        parameter.and_then(|parameter| answer(&parameter)).or_else(|| {
            let feedback = Feedback::decode(data, &self.ranges);
            (u16::from(feedback.id) == self.id & 0x0F).then_some(Answer::Feedback(feedback))
        })
    }
}

/// Answer to a parameter frame.
fn answer(parameter: &Parameter) -> Option<Answer> {
    let register = Register::from_address(parameter.address);
    let value = |register: Register| (register, register.value(parameter.value));
    match parameter.purpose {
        Purpose::Read => register.map(value).map(|(register, value)| Answer::Read(register, value)),
        Purpose::Write => register.map(value).map(|(register, value)| Answer::Written(register, value)),
        Purpose::Store => (parameter.address == parameter::STORE_ALL).then_some(Answer::Stored),
        Purpose::Refresh => None,
    }
}

//! Port to another board on a serial line, by the protocol of the role `observer`. New samples are sent once the last
//! ones are answered, so the line determines the exchange rate; a caller that waits for each answer runs in lockstep.
//! `serial` moves the bytes.

use link::controller::{Answered, Exchange};
use link::framing::{MAX_FRAME, Receiver, encode};
use link::messages::{FromBoard, Schedule, ToBoard};
use model_core::compensation::Command;
use model_core::controller::Answer;
use model_core::observer::Samples;

use super::{ControllerPort, PortError};
use crate::serial::LineEnd;

/// Bytes of the longest frames of an exchange: samples with a set-point to the board; acceptance and an answer with all
/// estimates and a probed width back. Tests check both.
pub const FRAME_BYTES: [u32; 2] = [88, 214];
/// Bits per byte on the line, including start and stop bit.
const BITS: u32 = 10;

/// Exchange rate of a line [Hz], by the direction with more bytes; the computation time is short in comparison. 107 at
/// 230400 baud, 430 at 921600.
pub const fn exchanges_per_second(baud_rate: u32) -> u32 {
    let [there, back] = FRAME_BYTES;
    let most = if there > back { there } else { back };
    baud_rate / (BITS * most)
}

/// Motor controller's side of the line; the caller has started the run by a reset.
pub struct SerialPort<'a> {
    line: LineEnd<'a>,
    receiver: Receiver,
    /// Control periods sent so far.
    asked: u32,
    /// Control periods answered so far.
    answered: u32,
}

impl<'a> SerialPort<'a> {
    /// Port on a line.
    pub fn new(line: LineEnd<'a>) -> Self {
        Self { line, receiver: Receiver::new(), asked: 0, answered: 0 }
    }

    /// Reads received bytes up to the first answer.
    fn listen(&mut self) -> Option<Answered> {
        for _ in 0..2 * MAX_FRAME {
            let byte = self.line.read()?;
            if let Some(FromBoard::Answer(answered)) = self.receiver.push(byte) {
                return Some(answered);
            }
        }
        None
    }
}

impl ControllerPort for SerialPort<'_> {
    /// Returns the answer to the samples sent last, once it has arrived; sends these samples then, else drops them.
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Result<Answer<f32>, PortError> {
        self.ask(Exchange::new(self.asked, samples, command))
    }

    fn probe(&mut self, samples: &Samples<f32>) -> Result<Answer<f32>, PortError> {
        self.ask(Exchange::probing(self.asked, samples))
    }

    fn reset(&mut self) {
        (self.asked, self.answered) = (0, 0);
        self.receiver.clear();
    }
}

impl SerialPort<'_> {
    fn ask(&mut self, exchange: Exchange) -> Result<Answer<f32>, PortError> {
        let answered = self.listen();
        if let Some(answered) = &answered {
            self.answered = answered.tick;
        }
        if self.asked == self.answered && self.line.room() >= MAX_FRAME {
            let (sequence, horizon) = (self.asked as u16, self.asked.wrapping_add(1));
            let mut commands = heapless::Vec::new();
            // The vector has room for four.
            let _ = commands.push(exchange);
            let message = ToBoard::Exchanges(Schedule { sequence, horizon, commands });
            let frame = encode(&message).map_err(|_| PortError::Damaged)?;
            self.line.write(&frame);
            self.asked = horizon;
        }
        answered.and_then(|answered| answered.answer()).ok_or(PortError::Late)
    }
}

//! Observer and compensation on a board, a control period at a time over its line: lockstep, so that every period has its
//! answer however slow the line is. Finding the board and starting its run is the caller's business.

use std::cell::RefCell;
use std::rc::Rc;

use link::controller::Exchange;
use model_core::digest;
use model_core::realtime::compensation::Command;
use model_core::realtime::observer::Samples;

use crate::failure::{Failure, Outcome};
use crate::hil::session::Session;
use crate::trial::port::{Answer, ControllerPort};

/// A board that answers.
pub struct BoardPort<'s> {
    session: Rc<RefCell<Session<'s>>>,
    tick: u32,
    /// Running digest over the answers as they came: the board takes its own in the tick that makes them.
    digest: u64,
}

impl<'s> BoardPort<'s> {
    /// A session whose run has begun and has done nothing yet.
    pub fn new(session: Rc<RefCell<Session<'s>>>) -> Self {
        Self { session, tick: 0, digest: digest::START }
    }
}

impl ControllerPort for BoardPort<'_> {
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer> {
        let exchange = Exchange::new(self.tick, samples, command);
        self.tick = self.tick.wrapping_add(1);
        let answered = self.session.borrow_mut().exchange(exchange)?;
        let answer = answered.answer().ok_or_else(|| Failure::check_failed("the board answered without estimates"))?;
        self.digest = answer.digest(self.digest);
        if self.digest == answered.digest {
            return Ok(answer);
        }
        let period = self.tick.wrapping_sub(1);
        Err(Failure::check_failed(format!("the answer to control period {period} is not the one that the board made"))
            .with_help("it was changed between the board's tick and here: look at the board's stack and interrupts"))
    }
}

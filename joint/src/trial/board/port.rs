//! Observer and compensation on a board, a control period at a time over its line: lockstep, so that every period has its
//! answer however slow the line is. Finding the board and starting its run is the caller's business.

use std::cell::RefCell;
use std::rc::Rc;

use link::controller::Exchange;
use model_core::realtime::compensation::Command;
use model_core::realtime::observer::Samples;

use crate::failure::{Failure, Outcome};
use crate::hil::session::Session;
use crate::trial::port::{Answer, ControllerPort};

/// A board that answers.
pub struct BoardPort<'s> {
    session: Rc<RefCell<Session<'s>>>,
    tick: u32,
}

impl<'s> BoardPort<'s> {
    /// A session whose run has begun and has done nothing yet.
    pub fn new(session: Rc<RefCell<Session<'s>>>) -> Self {
        Self { session, tick: 0 }
    }
}

impl ControllerPort for BoardPort<'_> {
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer> {
        let exchange = Exchange::new(self.tick, samples, command);
        self.tick = self.tick.wrapping_add(1);
        let answered = self.session.borrow_mut().exchange(exchange)?;
        answered.answer().ok_or_else(|| Failure::check_failed("the board answered without estimates"))
    }
}

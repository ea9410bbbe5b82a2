//! Observer and compensation on a board, one control period at a time over its line, in lockstep: every period is
//! answered, however slow the line.

use std::cell::RefCell;
use std::rc::Rc;

use link::controller::{Exchange, WireShaped};
use model_core::compensation::Command;
use model_core::numbers::digest;
use model_core::observer::{Memory, Samples};

use crate::case::Designed;
use crate::port::{Answer, ControllerPort, HostPort};
use board::session::Session;
use report::failure::{Failure, Outcome};

/// A board and its twin on the host. The board's digest over all answers so far, computed in the tick of each answer,
/// must equal the twin's. The twin's estimates then equal the board's and need not be sent over the line.
pub struct BoardPort<'d> {
    session: Rc<RefCell<Session<'static>>>,
    twin: HostPort<'d>,
    tick: u32,
    digest: u64,
}

impl<'d> BoardPort<'d> {
    /// Port for a session whose run has just begun.
    pub fn new(session: Rc<RefCell<Session<'static>>>, designed: &'d Designed) -> Self {
        let twin = HostPort::new(designed);
        Self { session, twin, tick: 0, digest: digest::START }
    }
}

impl ControllerPort for BoardPort<'_> {
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer> {
        let own = self.twin.exchange(samples, command)?;
        self.ask(Exchange::new(self.tick, samples, command), own)
    }

    fn probe(&mut self, samples: &Samples<f32>) -> Outcome<Answer> {
        let own = self.twin.probe(samples)?;
        self.ask(Exchange::probing(self.tick, samples), own)
    }

    fn restart_from_memory(&mut self) -> Outcome<Memory> {
        (self.tick, self.digest) = (0, digest::START);
        self.session.borrow_mut().restart_from_memory()?;
        self.twin.restart_from_memory()
    }
}

impl BoardPort<'_> {
    /// Sends an exchange to the board and compares its answer with the twin's.
    fn ask(&mut self, exchange: Exchange, answer: Answer) -> Outcome<Answer> {
        let answered = self.session.borrow_mut().exchange(exchange.without_estimates())?;
        self.digest = answer.digest(self.digest);
        let own = WireShaped::from(&answer.shaped);
        if answered.digest != self.digest || answered.shaped != own || answered.probed.map(Into::into) != answer.probed
        {
            let (on_board, on_host) = (answered.shaped.torque, own.torque);
            let what = if on_board == on_host {
                "estimates".to_owned()
            } else {
                format!("torque {on_board:e} on the board, {on_host:e} on the host")
            };
            return Err(Failure::check_failed(format!(
                "board and host differ in control period {}: {what}",
                self.tick
            )));
        }
        self.tick = self.tick.wrapping_add(1);
        Ok(answer)
    }
}

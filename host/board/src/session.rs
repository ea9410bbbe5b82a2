//! A conversation with a board: find it, reset it, hear it out, stop it. What was heard so far is kept whatever happens;
//! nothing is judged here.
//!
//! `hearing` sends and waits, `identity` says whether it is the right board and `mend` what to do if it is not; `stream` and
//! `control` are the runs, `memory` is about what a board has learnt.

mod control;
mod hearing;
mod identity;
mod memory;
mod mend;
mod stream;

use std::time::{Duration, Instant};

use link::PROTOCOL_VERSION;
use link::framing::Receiver;
use link::messages::{Hello, RunSettings, ToBoard};

use super::recording::{Recording, Unanswered};
use super::transport::Line;
use report::failure::{Failure, Outcome};

pub use identity::Expected;
use identity::HelloHead;
pub use mend::Mend;

/// Longest silence of a board that has something to say.
pub const SILENCE: Duration = Duration::from_secs(2);
/// Time between two calls of the host to a board that has not answered yet.
const PING: Duration = Duration::from_millis(100);
/// Longest wait for a line to become quiet.
const DRAIN: Duration = Duration::from_secs(1);

/// What a session asks about its surroundings at every slice of waiting.
pub trait Surroundings {
    /// The user wants to stop.
    fn interrupted(&self) -> bool;
    /// Why the other end is gone, if it is known to be.
    fn gone(&mut self) -> Option<String> {
        None
    }
}

/// A conversation with a board.
pub struct Session<'a> {
    line: Box<dyn Line + 'a>,
    surroundings: Box<dyn Surroundings + 'a>,
    receiver: Receiver,
    head_receiver: Option<Receiver>,
    foreign: Option<HelloHead>,
    dropped_before: u32,
    unanswered: Unanswered,
    /// All that was heard.
    pub recording: Recording,
}

impl<'a> Session<'a> {
    /// A session on a line; nothing is sent yet.
    pub fn new(line: Box<dyn Line + 'a>, surroundings: Box<dyn Surroundings + 'a>) -> Self {
        Self {
            line,
            surroundings,
            receiver: Receiver::new(),
            head_receiver: Some(Receiver::new()),
            foreign: None,
            dropped_before: 0,
            unanswered: Unanswered::default(),
            recording: Recording::default(),
        }
    }

    /// Calls the board until it answers, and refuses one that is not as expected.
    pub fn connect(&mut self, expected: &Expected, patience: Duration) -> Outcome<Hello> {
        let hello = self.call(&expected.mend, patience)?;
        expected.verify(&hello)?;
        Ok(hello)
    }

    /// Calls the board until it answers, whatever it is as long as it can be understood; `mend` is for a board that cannot be.
    pub fn call(&mut self, mend: &Mend, patience: Duration) -> Outcome<Hello> {
        let deadline = Instant::now() + patience;
        let mut next_ping = Instant::now();
        while self.recording.hello.is_none() {
            if Instant::now() >= next_ping {
                self.send(&ToBoard::Hello { protocol: PROTOCOL_VERSION })?;
                next_ping = Instant::now() + PING;
            }
            self.hear()?;
            if let Some(head) = self.foreign {
                return Err(head.refusal(mend));
            }
            if Instant::now() > deadline {
                return Err(self.no_answer(patience, mend));
            }
        }
        self.head_receiver = None;
        self.recording.hello.clone().ok_or_else(|| Failure::new("the board gave no name"))
    }

    /// Brings the board to rest at tick 0, whatever it was doing, with all counts cleared.
    pub fn reset(&mut self, settings: RunSettings) -> Outcome<()> {
        self.send(&ToBoard::Stop)?;
        self.drain()?;
        self.recording.hello = None;
        self.recording.trips.clear();
        self.send(&ToBoard::Reset(settings))?;
        self.wait("answer to a reset", |recording| recording.hello.is_some())?;
        self.recording.statistics = None;
        self.send(&ToBoard::Statistics { reset: true })?;
        self.wait("statistics", |recording| recording.statistics.is_some())?;
        self.dropped_before = self.receiver.dropped().frames;
        self.recording.start_run(settings);
        self.unanswered = Unanswered::default();
        Ok(())
    }

    /// Asks for the statistics of the run, then ends it. Samples after `last_tick` are no part of it: in real time the
    /// board goes on until it is stopped.
    pub fn finish(&mut self, last_tick: u32) -> Outcome<()> {
        self.recording.statistics = None;
        self.send(&ToBoard::Statistics { reset: false })?;
        self.wait("statistics", |recording| recording.statistics.is_some())?;
        self.send(&ToBoard::Stop)?;
        self.drain()?;
        self.recording.keep_until(last_tick);
        Ok(())
    }

    /// Ends a run that has gone wrong: stops the board and takes what it still says, as far as that can be had.
    pub fn abandon(&mut self) {
        let quickly = |result: Outcome<()>| result.is_ok();
        self.recording.statistics = None;
        let asked = quickly(self.send(&ToBoard::Stop)) && quickly(self.send(&ToBoard::Statistics { reset: false }));
        let deadline = Instant::now() + DRAIN;
        while asked && self.recording.statistics.is_none() && Instant::now() < deadline {
            if self.hear_regardless().is_err() {
                return;
            }
        }
    }
}

//! A session with a board: connect, reset, run, stop. Whatever was received before an error is kept in `recording`.
//!
//! `line_io` sends, receives and enforces timeouts; `identity` checks that the board runs the expected image and `help`
//! says what to do if it does not; `stream` and `control` are the runs of the roles, `memory` reads and writes what a
//! board has learnt.

mod control;
mod help;
mod identity;
mod line_io;
mod memory;
mod stream;

use std::time::{Duration, Instant};

use link::PROTOCOL_VERSION;
use link::framing::Receiver;
use link::messages::{Hello, RunSettings, ToBoard};

use super::recording::{Recording, UnacknowledgedSchedules};
use super::transport::Line;
use report::failure::{Failure, Outcome};
use report::interruption::UninterruptedWork;

pub use help::BoardHelp;
pub use identity::Expected;
use identity::HelloHead;

/// Longest wait for an answer of a connected board.
pub const ANSWER_TIMEOUT: Duration = Duration::from_secs(2);
/// A real board that has not heard of its host for so long goes to its safe state [s].
const COMMAND_TIMEOUT: f64 = 0.1;
/// In a run a host that has nothing else to say says this often that it is there: three times in a timeout.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_millis(30);
/// Schedules with commands under way at once: the board's receive buffer holds two of the longest.
const SCHEDULES_IN_FLIGHT: usize = 2;
/// Empty ones beside them, of 16 bytes at most: while a slow line brings samples the answers are late.
const KEEP_ALIVES_IN_FLIGHT: usize = 8;
/// Time between two hello messages to a board that has not answered yet.
const HELLO_INTERVAL: Duration = Duration::from_millis(100);
/// Longest wait for the line to become idle.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(1);

/// What a session polls while it waits: has the user interrupted it, is the other end gone?
pub trait Supervisor {
    /// The user wants to stop.
    fn interrupted(&self) -> bool;
    /// Why the other end is gone, if it is known to be.
    fn gone(&mut self) -> Option<String> {
        None
    }
}

/// Command timeout of a board's runs, in ticks. There is none to speak of on the emulated board: its clock runs as fast as
/// it can while the host is thinking.
pub fn command_timeout(tick_rate: u32, emulated: bool) -> u32 {
    if emulated { u32::MAX } else { (COMMAND_TIMEOUT * f64::from(tick_rate)).ceil() as u32 }
}

/// A session with a board.
pub struct Session<'a> {
    line: Box<dyn Line + 'a>,
    supervisor: Box<dyn Supervisor + 'a>,
    receiver: Receiver,
    head_receiver: Option<Receiver>,
    foreign: Option<HelloHead>,
    dropped_before: u32,
    unacknowledged: UnacknowledgedSchedules,
    /// All that was received.
    pub recording: Recording,
    /// A board that runs is stopped before the process ends.
    _uninterrupted: UninterruptedWork,
}

impl<'a> Session<'a> {
    /// A session on a line; nothing is sent yet.
    pub fn new(line: Box<dyn Line + 'a>, supervisor: Box<dyn Supervisor + 'a>) -> Self {
        Self {
            line,
            supervisor,
            receiver: Receiver::new(),
            head_receiver: Some(Receiver::new()),
            foreign: None,
            dropped_before: 0,
            unacknowledged: UnacknowledgedSchedules::default(),
            recording: Recording::default(),
            _uninterrupted: UninterruptedWork::begin(),
        }
    }

    /// Calls the board until it answers, and refuses one that is not as expected.
    pub fn connect(&mut self, expected: &Expected, timeout: Duration) -> Outcome<Hello> {
        let hello = self.call(&expected.help, timeout)?;
        expected.verify(&hello)?;
        Ok(hello)
    }

    /// Calls the board until it answers, whatever it is as long as it can be understood; `help` is for a board that cannot be.
    pub fn call(&mut self, help: &BoardHelp, timeout: Duration) -> Outcome<Hello> {
        let deadline = Instant::now() + timeout;
        let mut next_ping = Instant::now();
        while self.recording.hello.is_none() {
            if Instant::now() >= next_ping {
                self.send(&ToBoard::Hello { protocol: PROTOCOL_VERSION })?;
                next_ping = Instant::now() + HELLO_INTERVAL;
            }
            self.receive()?;
            if let Some(head) = self.foreign {
                return Err(head.refusal(help));
            }
            if Instant::now() > deadline {
                return Err(self.no_answer(timeout, help));
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
        self.unacknowledged = UnacknowledgedSchedules::default();
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
        let deadline = Instant::now() + DRAIN_TIMEOUT;
        while asked && self.recording.statistics.is_none() && Instant::now() < deadline {
            if self.receive_uninterrupted().is_err() {
                return;
            }
        }
    }
}

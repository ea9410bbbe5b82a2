//! Session with a board: connect, reset, run, stop. Messages received before an error are kept in `recording`.
//!
//! `line_io` sends, receives and enforces timeouts; `identity` checks that the board runs the expected image and `help`
//! holds the remedies; `stream` and `control` are the runs of the roles; `memory` reads and writes the estimated
//! parameters of a board.

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
/// Time without a host message after which a real board enters its safe state [s].
const COMMAND_TIMEOUT: f64 = 0.1;
/// Interval of keep-alive messages during a run: three per command timeout.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_millis(30);
/// Limit of schedules with commands in flight: the board's receive buffer holds two of the longest.
const SCHEDULES_IN_FLIGHT: usize = 2;
/// Limit of empty schedules (at most 16 bytes) in flight, in addition to SCHEDULES_IN_FLIGHT: acknowledgements are late
/// while a slow line carries samples.
const KEEP_ALIVES_IN_FLIGHT: usize = 8;
/// Time between two hello messages to a board that has not answered yet.
const HELLO_INTERVAL: Duration = Duration::from_millis(100);
/// Longest wait for the line to become idle.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(1);

/// Conditions that a session polls while it waits.
pub trait Supervisor {
    /// Returns whether the user wants to stop.
    fn interrupted(&self) -> bool;
    /// Reason for which the other end is gone, if known.
    fn gone(&mut self) -> Option<String> {
        None
    }
}

/// Command timeout of a board's runs [ticks]. The emulated board has practically none, because its clock runs as fast
/// as it can while the host computes.
pub fn command_timeout(tick_rate: u32, emulated: bool) -> u32 {
    if emulated { u32::MAX } else { (COMMAND_TIMEOUT * f64::from(tick_rate)).ceil() as u32 }
}

/// Open session with a board.
pub struct Session<'a> {
    line: Box<dyn Line + 'a>,
    supervisor: Box<dyn Supervisor + 'a>,
    receiver: Receiver,
    head_receiver: Option<Receiver>,
    undecodable: Option<HelloHead>,
    dropped_before: u32,
    unacknowledged: UnacknowledgedSchedules,
    /// Messages received so far.
    pub recording: Recording,
    /// Keeps the process alive until a running board is stopped.
    _uninterrupted: UninterruptedWork,
}

impl<'a> Session<'a> {
    /// Session on a line; nothing is sent yet.
    pub fn new(line: Box<dyn Line + 'a>, supervisor: Box<dyn Supervisor + 'a>) -> Self {
        Self {
            line,
            supervisor,
            receiver: Receiver::new(),
            head_receiver: Some(Receiver::new()),
            undecodable: None,
            dropped_before: 0,
            unacknowledged: UnacknowledgedSchedules::default(),
            recording: Recording::default(),
            _uninterrupted: UninterruptedWork::begin(),
        }
    }

    /// Sends hello messages until the board answers, and rejects a board with another identity.
    pub fn connect(&mut self, expected: &Expected, timeout: Duration) -> Outcome<Hello> {
        let hello = self.wait_for_hello(&expected.help, timeout)?;
        expected.verify(&hello)?;
        Ok(hello)
    }

    /// Sends hello messages until the board answers; accepts any board whose hello can be decoded. `help` is the remedy
    /// for others.
    pub fn wait_for_hello(&mut self, help: &BoardHelp, timeout: Duration) -> Outcome<Hello> {
        let deadline = Instant::now() + timeout;
        let mut next_ping = Instant::now();
        while self.recording.hello.is_none() {
            if Instant::now() >= next_ping {
                self.send(&ToBoard::Hello { protocol: PROTOCOL_VERSION })?;
                next_ping = Instant::now() + HELLO_INTERVAL;
            }
            self.receive()?;
            if let Some(head) = self.undecodable {
                return Err(head.refusal(help));
            }
            if Instant::now() > deadline {
                return Err(self.no_answer(timeout, help));
            }
        }
        self.head_receiver = None;
        self.recording.hello.clone().ok_or_else(|| Failure::new("the board sent no hello"))
    }

    /// Stops the board and brings it to rest at tick 0 with all counters cleared.
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

    /// Requests the statistics of the run, then ends it. Samples after `last_tick` are dropped: in real time the board
    /// runs until it is stopped.
    pub fn finish(&mut self, last_tick: u32) -> Outcome<()> {
        self.recording.statistics = None;
        self.send(&ToBoard::Statistics { reset: false })?;
        self.wait("statistics", |recording| recording.statistics.is_some())?;
        self.send(&ToBoard::Stop)?;
        self.drain()?;
        self.recording.drop_samples_after(last_tick);
        Ok(())
    }

    /// Ends a failed run: stops the board and collects its last messages as far as the line allows.
    pub fn abandon(&mut self) {
        let succeeded = |result: Outcome<()>| result.is_ok();
        self.recording.statistics = None;
        let asked = succeeded(self.send(&ToBoard::Stop)) && succeeded(self.send(&ToBoard::Statistics { reset: false }));
        let deadline = Instant::now() + DRAIN_TIMEOUT;
        while asked && self.recording.statistics.is_none() && Instant::now() < deadline {
            if self.receive_uninterrupted().is_err() {
                return;
            }
        }
    }
}

//! A conversation with a board: find it, reset it, stream torques within its queue, hear it out. Every wait has a
//! deadline, and what was heard so far is kept whatever happens; nothing is judged here.

mod control;
mod identity;
mod memory;
mod stream;

use std::time::{Duration, Instant};

use link::PROTOCOL_VERSION;
use link::framing::{Receiver, encode};
use link::messages::{FromBoard, Hello, RunSettings, ToBoard};

use super::recording::{Recording, Unanswered};
use super::transport::Line;
use crate::failure::{Failure, Outcome};

pub use identity::Expected;
use identity::HelloHead;

/// Longest silence of a board that has something to say.
pub const SILENCE: Duration = Duration::from_secs(2);
/// Time between two calls of the host to a board that has not answered yet.
const PING: Duration = Duration::from_millis(100);
/// A line that has been quiet for so long has nothing more under way.
const QUIET: Duration = Duration::from_millis(100);
/// Longest wait for a line to become quiet.
const DRAIN: Duration = Duration::from_secs(1);

/// What a session asks about its surroundings at every slice of waiting.
pub trait Surroundings {
    /// The user wants to stop.
    fn interrupted(&self) -> bool;
    /// Why the other end is gone, if it is known to be.
    fn gone(&mut self) -> Option<String>;
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

    /// Calls the board until it answers, whatever it is as long as it can be understood; `mend` is the command that puts an
    /// image onto it.
    pub fn call(&mut self, mend: &str, patience: Duration) -> Outcome<Hello> {
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
        self.recording.faults.clear();
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

    fn send(&mut self, message: &ToBoard) -> Outcome<()> {
        let frame = encode(message).map_err(|_| Failure::new("a message to the board is longer than a frame"))?;
        match self.line.send(&frame) {
            Ok(()) => {
                self.recording.traffic.sent_bytes += frame.len() as u64;
                Ok(())
            }
            Err(error) => {
                // What had come before the line broke is still there to be heard.
                let deadline = Instant::now() + DRAIN;
                while Instant::now() < deadline && self.hear_regardless().is_ok_and(|messages| !messages.is_empty()) {}
                Err(self.lost(&error))
            }
        }
    }

    /// Takes what has come within a slice of time.
    fn hear(&mut self) -> Outcome<Vec<FromBoard>> {
        if self.surroundings.interrupted() {
            return Err(Failure::interrupted("stopped by the user"));
        }
        self.hear_regardless()
    }

    fn hear_regardless(&mut self) -> Outcome<Vec<FromBoard>> {
        let mut buffer = [0; 4096];
        let count = match self.line.receive(&mut buffer) {
            Ok(count) => count,
            Err(error) => return Err(self.lost(&error)),
        };
        self.recording.traffic.received_bytes += count as u64;
        let mut messages = Vec::new();
        for &byte in &buffer[..count] {
            if let Some(message) = self.receiver.push::<FromBoard>(byte) {
                if let FromBoard::Accepted(accepted) = &message {
                    self.recording.accepted.extend(self.unanswered.answered(*accepted));
                }
                self.recording.take(message.clone());
                messages.push(message);
            }
            if let Some(head) = self.head_receiver.as_mut().and_then(|receiver| receiver.push::<HelloHead>(byte)) {
                self.foreign = Some(head).filter(|head| head.is_foreign());
            }
        }
        self.recording.traffic.bad_frames = self.receiver.dropped().frames - self.dropped_before;
        Ok(messages)
    }

    /// Waits for something to be heard; gives up after [`SILENCE`].
    fn wait(&mut self, what: &str, done: impl Fn(&Recording) -> bool) -> Outcome<()> {
        let start = Instant::now();
        while !done(&self.recording) {
            self.hear()?;
            if let Some(fault) = self.recording.faults.first() {
                return Err(super::fault::failure(fault));
            }
            if start.elapsed() > SILENCE {
                return Err(self.silent(&format!("no {what} came")));
            }
        }
        Ok(())
    }

    /// Sends a message and waits for its answer.
    fn ask<T>(
        &mut self,
        message: &ToBoard,
        what: &str,
        patience: Duration,
        answer: impl Fn(FromBoard) -> Option<T>,
    ) -> Outcome<T> {
        self.send(message)?;
        let start = Instant::now();
        loop {
            for message in self.hear()? {
                if let FromBoard::Fault(raised) = &message {
                    return Err(super::fault::failure(raised));
                }
                if let Some(answer) = answer(message) {
                    return Ok(answer);
                }
            }
            if start.elapsed() > patience {
                return Err(self.silent_for(patience, &format!("no {what} came")));
            }
        }
    }

    /// Listens until nothing is under way any more.
    fn drain(&mut self) -> Outcome<()> {
        let deadline = Instant::now() + DRAIN;
        let mut last = Instant::now();
        while last.elapsed() < QUIET && Instant::now() < deadline {
            let before = self.recording.traffic.received_bytes;
            self.hear()?;
            if self.recording.traffic.received_bytes != before {
                last = Instant::now();
            }
        }
        Ok(())
    }

    fn no_answer(&self, patience: Duration, mend: &str) -> Failure {
        let (name, seconds) = (self.line.name(), patience.as_secs_f64());
        let bytes = self.recording.traffic.received_bytes;
        if bytes == 0 {
            let message = format!("no board answers on {name}: nothing came in {seconds} s");
            return Failure::new(message)
                .with_help(format!("check power, wiring (TX to RX) and port; flash the image if need be: {mend}"));
        }
        let message = format!("no board answers on {name}: {bytes} bytes came in {seconds} s, but no valid frame");
        Failure::new(message).with_help(format!("check --baud, and that this checkout's image is on the board: {mend}"))
    }

    fn silent(&self, what: &str) -> Failure {
        self.silent_for(SILENCE, what)
    }

    fn silent_for(&self, patience: Duration, what: &str) -> Failure {
        let traffic = &self.recording.traffic;
        let message = format!(
            "the board on {} has fallen silent at tick {}: {what} for {} s ({} bad frames dropped)",
            self.line.name(),
            self.recording.last_tick(),
            patience.as_secs(),
            traffic.bad_frames
        );
        Failure::new(message).with_help("check the line and the board's power, reset the board and run again")
    }

    fn lost(&mut self, error: &std::io::Error) -> Failure {
        let name = self.line.name().to_owned();
        let tick = self.recording.last_tick();
        match self.surroundings.gone() {
            Some(why) => Failure::new(format!("{name} is gone at tick {tick}: {why}"))
                .with_help("run again; if it happens again its last words are above or in the run's log"),
            None => Failure::new(format!("the line to {name} was lost at tick {tick}: {error}"))
                .with_help("check the cable and the board's power, then run again"),
        }
    }
}

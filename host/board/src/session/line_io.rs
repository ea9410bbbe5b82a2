//! Sending, receiving and waiting on the line. Every wait has a timeout, and its error says what to check.

use std::time::{Duration, Instant};

use link::framing::encode;
use link::messages::{FromBoard, ToBoard};

use super::{ANSWER_TIMEOUT, BoardHelp, DRAIN_TIMEOUT, HelloHead, Session};
use crate::recording::Recording;
use crate::trip;
use report::failure::{Failure, Outcome};

/// Time without a byte after which a line is idle.
const IDLE_TIME: Duration = Duration::from_millis(100);

impl Session<'_> {
    /// Sends a message after a zero byte, which ends an incomplete frame in the board's receiver.
    pub(super) fn send(&mut self, message: &ToBoard) -> Outcome<()> {
        let frame = encode(message).map_err(|_| Failure::new("a message to the board is longer than a frame"))?;
        let frame = [&[0], &frame[..]].concat();
        match self.line.send(&frame) {
            Ok(()) => {
                self.recording.traffic.sent_bytes += frame.len() as u64;
                Ok(())
            }
            Err(error) => {
                // Bytes that arrived before the line broke can still be read.
                let deadline = Instant::now() + DRAIN_TIMEOUT;
                while Instant::now() < deadline
                    && self.receive_uninterrupted().is_ok_and(|messages| !messages.is_empty())
                {}
                Err(self.line_lost(&error))
            }
        }
    }

    /// Receives messages for up to one receive timeout; fails if the user has interrupted the session.
    pub(super) fn receive(&mut self) -> Outcome<Vec<FromBoard>> {
        if self.supervisor.interrupted() {
            return Err(Failure::interrupted("stopped by the user"));
        }
        self.receive_uninterrupted()
    }

    pub(super) fn receive_uninterrupted(&mut self) -> Outcome<Vec<FromBoard>> {
        let mut buffer = [0; 4096];
        let count = match self.line.receive(&mut buffer) {
            Ok(count) => count,
            Err(error) => return Err(self.line_lost(&error)),
        };
        self.recording.traffic.received_bytes += count as u64;
        let mut messages = Vec::new();
        for &byte in &buffer[..count] {
            if let Some(message) = self.receiver.push::<FromBoard>(byte) {
                if let FromBoard::Accepted(accepted) = &message {
                    self.recording.accepted.extend(self.unacknowledged.remove(*accepted));
                }
                self.recording.store(message.clone());
                messages.push(message);
            }
            if let Some(head) =
                self.head_receiver.as_mut().and_then(|receiver| receiver.push_beginning::<HelloHead>(byte))
            {
                self.undecodable = Some(head).filter(|head| head.is_undecodable());
            }
        }
        self.recording.traffic.bad_frames = self.receiver.dropped().frames - self.dropped_before;
        Ok(messages)
    }

    /// Waits until the recording satisfies `done`; fails after [`ANSWER_TIMEOUT`].
    pub(super) fn wait(&mut self, what: &str, done: impl Fn(&Recording) -> bool) -> Outcome<()> {
        let start = Instant::now();
        while !done(&self.recording) {
            self.receive()?;
            if let Some(trip) = self.recording.trips.first() {
                return Err(trip::failure(trip));
            }
            if start.elapsed() > ANSWER_TIMEOUT {
                return Err(self.silence(&format!("no {what} came")));
            }
        }
        Ok(())
    }

    /// Sends a message and waits for its answer.
    pub(super) fn request<T>(
        &mut self,
        message: &ToBoard,
        what: &str,
        timeout: Duration,
        answer: impl Fn(FromBoard) -> Option<T>,
    ) -> Outcome<T> {
        self.send(message)?;
        let start = Instant::now();
        loop {
            for message in self.receive()? {
                if let FromBoard::Tripped(raised) = &message {
                    return Err(trip::failure(raised));
                }
                if let Some(answer) = answer(message) {
                    return Ok(answer);
                }
            }
            if start.elapsed() > timeout {
                return Err(self.silence_for(timeout, &format!("no {what} came")));
            }
        }
    }

    /// Receives until the line is idle.
    pub(super) fn drain(&mut self) -> Outcome<()> {
        let deadline = Instant::now() + DRAIN_TIMEOUT;
        let mut last = Instant::now();
        while last.elapsed() < IDLE_TIME && Instant::now() < deadline {
            let before = self.recording.traffic.received_bytes;
            self.receive()?;
            if self.recording.traffic.received_bytes != before {
                last = Instant::now();
            }
        }
        Ok(())
    }

    pub(super) fn no_answer(&self, timeout: Duration, help: &BoardHelp) -> Failure {
        let (name, seconds) = (self.line.name(), timeout.as_secs_f64());
        let bytes = self.recording.traffic.received_bytes;
        if bytes == 0 {
            let message = format!("no board answers on {name}: nothing came in {seconds} s");
            return Failure::new(message).with_help(help.no_valid_frame("check power, wiring (TX to RX) and port"));
        }
        let message = format!("no board answers on {name}: {bytes} bytes came in {seconds} s, but no valid frame");
        Failure::new(message)
            .with_help(help.no_valid_frame("check --baud, and that this checkout's image is on the board"))
    }

    pub(super) fn silence(&self, what: &str) -> Failure {
        self.silence_for(ANSWER_TIMEOUT, what)
    }

    pub(super) fn silence_for(&self, timeout: Duration, what: &str) -> Failure {
        let traffic = &self.recording.traffic;
        let message = format!(
            "the board on {} has fallen silent at tick {}: {what} for {} s ({} bad frames dropped)",
            self.line.name(),
            self.recording.last_tick(),
            timeout.as_secs(),
            traffic.bad_frames
        );
        Failure::new(message).with_help("check the line and the board's power, reset the board and run again")
    }

    pub(super) fn line_lost(&mut self, error: &std::io::Error) -> Failure {
        let name = self.line.name().to_owned();
        let tick = self.recording.last_tick();
        match self.supervisor.gone() {
            Some(why) => Failure::new(format!("{name} is gone at tick {tick}: {why}"))
                .with_help("run again; if it happens again, read the output above or the run's log"),
            None => Failure::new(format!("the line to {name} was lost at tick {tick}: {error}"))
                .with_help("check the cable and the board's power, then run again"),
        }
    }
}

//! Node on the bus: frames that wait, error counters, and the states that follow from them.
//!
//! ```text
//! transmitter:  TEC + 8 for an error, - 1 for a success
//! receiver:     REC + 1 for an error, - 1 for a success, from above 127 back to 120
//! error passive: TEC or REC above 127     bus-off: TEC above 255, until 128 times 11 recessive bits
//! ```
//!
//! A receiver that sends its error flag first would count 8 more; all nodes of this bus see an error in the same bit. An
//! error-passive transmitter that misses an acknowledgement does not count.

use std::collections::VecDeque;

use drives::Frame;
use serde::Serialize;

/// Frames that wait in a drive; more are lost. Assumed: mailboxes and a small queue of the firmware.
const DEPTH: usize = 32;
/// Sequences of 11 recessive bits before a node returns from bus-off.
const RECOVERY: f64 = 128.0;
/// Error counter above which a node is error passive.
const PASSIVE: u16 = 127;
/// Error counter above which a transmitter is off the bus.
const OFF: u16 = 255;
/// Receive error counter after a success of an error-passive receiver: from 119 to 127.
const RECOVERED: u16 = 120;

/// State of a node by its error counters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorState {
    /// Error flags of the node destroy the frame for all nodes.
    ErrorActive,
    /// Error flags of the node disturb its own frames only.
    ErrorPassive,
    /// The node neither sends nor receives.
    BusOff,
}

/// Frame that waits, and the time from which on it may be sent [s].
#[derive(Debug, Clone)]
pub struct Waiting {
    pub frame: Frame,
    pub since: f64,
}

/// Node on the bus.
#[derive(Debug, Default)]
pub struct Node {
    queue: VecDeque<Waiting>,
    transmit_errors: u16,
    receive_errors: u16,
    /// Sequences of recessive bits that a node off the bus waits for.
    recovery: f64,
    /// Share of the node's frames that noise destroys [-].
    pub noise: f64,
    /// Time before which an error-passive transmitter does not send again [s].
    pub suspended_until: f64,
    /// True for a queue without a limit.
    is_unlimited: bool,
    /// Frames that found the queue full.
    pub overflows: u64,
    /// Times at which the node went off the bus.
    pub bus_offs: u64,
}

impl Node {
    /// Node whose queue has no limit, because its owner stops in time.
    pub fn unlimited() -> Self {
        Self { is_unlimited: true, ..Self::default() }
    }

    /// State by the error counters.
    pub fn state(&self) -> ErrorState {
        if self.transmit_errors > OFF {
            ErrorState::BusOff
        } else if self.transmit_errors > PASSIVE || self.receive_errors > PASSIVE {
            ErrorState::ErrorPassive
        } else {
            ErrorState::ErrorActive
        }
    }

    /// True unless the node is off the bus.
    pub fn is_on_bus(&self) -> bool {
        self.state() != ErrorState::BusOff
    }

    /// Error counters of transmitter and receiver.
    pub fn counters(&self) -> (u16, u16) {
        (self.transmit_errors, self.receive_errors)
    }

    /// Adds a frame to the queue.
    pub fn enqueue(&mut self, frame: Frame, since: f64) {
        if self.is_unlimited || self.queue.len() < DEPTH {
            self.queue.push_back(Waiting { frame, since });
        } else {
            self.overflows += 1;
        }
    }

    /// Number of frames that wait.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// Next frame of a node on the bus, and the time from which on it may be sent [s].
    pub fn front(&self) -> Option<(&Frame, f64)> {
        let first = self.queue.front().filter(|_| self.is_on_bus())?;
        Some((&first.frame, first.since.max(self.suspended_until)))
    }

    /// Counts a frame that was sent; returns it.
    pub fn sent(&mut self) -> Option<Frame> {
        self.transmit_errors = self.transmit_errors.saturating_sub(1);
        self.queue.pop_front().map(|waiting| waiting.frame)
    }

    /// Counts an error as the transmitter of a frame. Returns true if the node goes off the bus. A node that a command
    /// took off the bus while its frame was on its way counts no more.
    pub fn fail_to_send(&mut self) -> bool {
        if !self.is_on_bus() {
            return false;
        }
        self.transmit_errors += 8;
        let is_off = self.transmit_errors > OFF;
        if is_off {
            self.bus_offs += 1;
            self.recovery = RECOVERY;
        }
        is_off
    }

    /// Takes the node off the bus, as a burst of errors does. Returns true if it was on the bus.
    pub fn force_off(&mut self) -> bool {
        let was_on = self.is_on_bus();
        if was_on {
            self.transmit_errors = OFF;
            self.fail_to_send();
        }
        was_on
    }

    /// Counts a frame that was received.
    pub fn received(&mut self) {
        self.receive_errors =
            if self.receive_errors > PASSIVE { RECOVERED } else { self.receive_errors.saturating_sub(1) };
    }

    /// Counts an error as a receiver. The counter of an error-passive receiver stays.
    pub fn fail_to_receive(&mut self) {
        if self.receive_errors <= PASSIVE {
            self.receive_errors += 1;
        }
    }

    /// Counts sequences of 11 recessive bits. Returns true if the node returns to the bus.
    pub fn recover(&mut self, sequences: f64) -> bool {
        if self.is_on_bus() {
            return false;
        }
        self.recovery -= sequences;
        let returns = self.recovery <= 0.0;
        if returns {
            (self.transmit_errors, self.receive_errors) = (0, 0);
        }
        returns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_errors_make_a_node_passive() {
        let mut node = Node::default();
        (0..15).for_each(|_| assert!(!node.fail_to_send()));
        assert_eq!(node.state(), ErrorState::ErrorActive);
        assert!(!node.fail_to_send());
        assert_eq!((node.state(), node.counters()), (ErrorState::ErrorPassive, (128, 0)));
        node.sent();
        assert_eq!(node.state(), ErrorState::ErrorActive);
    }

    #[test]
    fn node_off_the_bus_returns_after_128_sequences() {
        let mut node = Node::default();
        let errors = (1..).find(|_| node.fail_to_send());
        assert_eq!((errors, node.state(), node.bus_offs), (Some(32), ErrorState::BusOff, 1));
        assert!(!node.recover(127.0) && node.front().is_none());
        assert!(node.recover(1.0) && node.is_on_bus());
        assert_eq!(node.counters(), (0, 0));
    }

    #[test]
    fn receiver_is_never_off_the_bus() {
        let mut node = Node::default();
        (0..1000).for_each(|_| node.fail_to_receive());
        assert_eq!((node.state(), node.counters()), (ErrorState::ErrorPassive, (0, 128)));
        node.received();
        assert_eq!((node.state(), node.counters()), (ErrorState::ErrorActive, (0, 120)));
    }

    #[test]
    fn full_queue_counts_what_it_loses() {
        let frame = Frame::classic(drives::frame::standard(1), &[]).unwrap();
        let mut node = Node::default();
        (0..DEPTH + 3).for_each(|_| node.enqueue(frame.clone(), 0.0));
        assert_eq!((node.waiting(), node.overflows), (DEPTH, 3));
        let mut client = Node::unlimited();
        (0..DEPTH + 3).for_each(|_| client.enqueue(frame.clone(), 0.0));
        assert_eq!((client.waiting(), client.overflows), (DEPTH + 3, 0));
    }
}

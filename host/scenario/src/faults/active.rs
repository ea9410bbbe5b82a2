//! One fault of a run with its state: whether it acts now, and its effect on an encoder's counts. Its effects on
//! set-points and torques are in `faults`.

use std::f64::consts::TAU;

use model_core::virtual_joint::fault::{EncoderShaft, FaultKind};

use crate::file::{Fault, Offset, fault_is_on, fault_stream};
use crate::random::RandomStream;

/// A fault with its state.
#[derive(Debug, Clone)]
pub(super) struct Active {
    pub fault: Fault,
    pub stream: RandomStream,
    /// Counts when the encoder froze, or counts that were lost.
    held: Option<i64>,
    lost: f64,
    before: Option<i64>,
    /// Fate of the last set-point that was sent.
    pub dropped: Option<(u64, bool)>,
}

impl Active {
    /// Nothing has gone wrong yet; `index` is its place in the file.
    pub fn new(fault: &Fault, index: usize, seed: u64) -> Self {
        Self::with_stream(fault, fault_stream(fault, index, seed))
    }

    /// Nothing has gone wrong yet; random numbers come from this stream.
    pub fn with_stream(fault: &Fault, stream: RandomStream) -> Self {
        Self { fault: *fault, stream, held: None, lost: 0.0, before: None, dropped: None }
    }

    /// What an encoder says in place of its counts.
    pub fn count(&mut self, time: f64, encoder: EncoderShaft, counts: i64, counts_per_turn: f64) -> i64 {
        let on = fault_is_on(&self.fault, time);
        match self.fault.kind {
            FaultKind::Frozen(of) if of == encoder => match (on, self.held) {
                (false, _) => {
                    self.held = None;
                    counts
                }
                (true, Some(held)) => held,
                (true, None) => {
                    self.held = Some(counts);
                    counts
                }
            },
            FaultKind::Offset(of, Offset { counts: offset, angle }) if of == encoder && on => {
                counts + (offset + angle / TAU * counts_per_turn).round() as i64
            }
            FaultKind::Noise(of, deviation) if of == encoder && on => {
                counts + (deviation * self.stream.normal()).round() as i64
            }
            FaultKind::Eccentric(of, error) if of == encoder && on => {
                let error = error * (counts as f64 / counts_per_turn * TAU).sin();
                counts + (error / TAU * counts_per_turn).round() as i64
            }
            FaultKind::MissingCounts(of, share) if of == encoder => {
                // What was not counted stays uncounted after the fault.
                let moved = counts - self.before.unwrap_or(counts);
                self.before = Some(counts);
                self.lost += if on { share * moved as f64 } else { 0.0 };
                counts - self.lost.trunc() as i64
            }
            _ => counts,
        }
    }
}

//! One fault of a run with its state: activity, and effect on an encoder's counts. Effects on set-points and torques
//! are in `faults`.

use std::f64::consts::TAU;

use model_core::virtual_joint::fault::{EncoderShaft, FaultKind};

use crate::file::{Fault, Offset, fault_is_active, fault_stream};
use crate::random::RandomStream;

/// A fault with its state.
#[derive(Debug, Clone)]
pub(super) struct ActiveFault {
    pub fault: Fault,
    pub stream: RandomStream,
    /// True for readings that an encoder drops by itself.
    pub is_of_encoder: bool,
    /// Counts at the start of a freeze (`frozen_counts`), lost counts, and the previous reading.
    frozen_counts: Option<i64>,
    lost_counts: f64,
    previous_counts: Option<i64>,
    /// Number of the last set-point that was sent, and whether it was lost.
    pub last_set_point: Option<(u64, bool)>,
}

impl ActiveFault {
    /// Fault in its initial state; `index` is its place in the file.
    pub fn new(fault: &Fault, index: usize, seed: u64) -> Self {
        Self::with_stream(fault, fault_stream(fault, index, seed))
    }

    /// Fault in its initial state, with random numbers from the given stream.
    pub fn with_stream(fault: &Fault, stream: RandomStream) -> Self {
        Self {
            fault: *fault,
            stream,
            is_of_encoder: false,
            frozen_counts: None,
            lost_counts: 0.0,
            previous_counts: None,
            last_set_point: None,
        }
    }

    /// Reading of an encoder under the fault.
    pub fn count(&mut self, time: f64, encoder: EncoderShaft, counts: i64, counts_per_turn: f64) -> i64 {
        let on = fault_is_active(&self.fault, time);
        match self.fault.kind {
            FaultKind::Frozen(of) if of == encoder => match (on, self.frozen_counts) {
                (false, _) => {
                    self.frozen_counts = None;
                    counts
                }
                (true, Some(frozen_counts)) => frozen_counts,
                (true, None) => {
                    self.frozen_counts = Some(counts);
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
                // Lost counts stay lost after the fault.
                let moved = counts - self.previous_counts.unwrap_or(counts);
                self.previous_counts = Some(counts);
                self.lost_counts += if on { share * moved as f64 } else { 0.0 };
                counts - self.lost_counts.trunc() as i64
            }
            _ => counts,
        }
    }
}

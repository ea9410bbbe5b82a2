//! One fault of a run with what it remembers: whether it is on, and what it does to an encoder's counts. Frames and torques
//! are the parent's.

use std::f64::consts::TAU;

use crate::draw::Stream;
use crate::file::{EncoderName, Fault, FaultKind};

/// A fault at work.
#[derive(Debug, Clone)]
pub(super) struct Active {
    pub fault: Fault,
    pub stream: Stream,
    /// Counts when the encoder froze, or counts that were lost.
    held: Option<i64>,
    lost: f64,
    before: Option<i64>,
    /// Fate of the last set-point that was sent.
    pub dropped: Option<(u64, bool)>,
}

impl Fault {
    /// Whether it is on at a time [s].
    pub fn is_on(&self, time: f64) -> bool {
        // Times are whole periods up to rounding.
        (self.start - 1e-9..self.end - 1e-9).contains(&time)
    }
}

impl Active {
    /// Nothing has gone wrong yet; `index` is its place in the file.
    pub fn new(fault: &Fault, index: usize, seed: u64) -> Self {
        Self {
            fault: fault.clone(),
            stream: Stream::new(seed, &format!("fault {index} {}", fault.word)),
            held: None,
            lost: 0.0,
            before: None,
            dropped: None,
        }
    }

    /// What an encoder says in place of its counts.
    pub fn count(&mut self, time: f64, encoder: EncoderName, counts: i64, counts_per_turn: f64) -> i64 {
        let on = self.fault.is_on(time);
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
            FaultKind::Offset(of, offset, angle) if of == encoder && on => {
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

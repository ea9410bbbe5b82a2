//! Collects samples in wire form into batches with consecutive numbers. `conversation` sends a batch when the line has
//! room.

use heapless::Vec;
use link::messages::FromBoard;

use crate::protocol::{Batch, WireForm};

/// Collects samples.
pub struct Batcher<F: WireForm<MOST>, const MOST: usize> {
    sequence: u16,
    samples: Vec<F::Wire, MOST>,
}

impl<F: WireForm<MOST>, const MOST: usize> Default for Batcher<F, MOST> {
    fn default() -> Self {
        Self { sequence: 0, samples: Vec::new() }
    }
}

impl<F: WireForm<MOST>, const MOST: usize> Batch for Batcher<F, MOST> {
    type Sample = F::Raw;

    fn add(&mut self, raw: &F::Raw) {
        let _ = self.samples.push(F::wire(raw));
    }

    fn is_full(&self) -> bool {
        self.samples.is_full()
    }

    fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    fn take(&mut self) -> FromBoard {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        F::message(sequence, core::mem::take(&mut self.samples))
    }
}

#[cfg(test)]
mod tests {
    use link::messages::SAMPLES_PER_BATCH;

    use super::*;
    use crate::telemetry::PlantForm;

    /// A batch that was taken leaves an empty one.
    #[test]
    fn batches_numbered_without_gaps() {
        let mut batcher = Batcher::<PlantForm<3>, SAMPLES_PER_BATCH>::default();
        for sequence in 0..3 {
            assert!(matches!(batcher.take(), FromBoard::Samples(batch) if batch.sequence == sequence));
            assert!(batcher.is_empty());
        }
    }
}

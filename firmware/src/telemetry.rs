//! From the plant's raw samples to batches on the wire, numbered without gaps. When a batch is sent is decided by
//! `conversation`, which knows how much room the line has.

use heapless::Vec;
use link::messages::{FromBoard, MAX_MESHES, SAMPLES_PER_BATCH, Sample, SampleBatch};
use model_core::mesh::ContactState;

use crate::plant::RawSample;
use crate::words::Batch;

/// Collects samples into batches.
#[derive(Debug, Default)]
pub struct Batcher<const N: usize> {
    sequence: u16,
    samples: Vec<Sample, SAMPLES_PER_BATCH>,
}

impl<const N: usize> Batch for Batcher<N> {
    type Sample = RawSample<N>;

    fn add(&mut self, raw: &RawSample<N>) {
        let _ = self.samples.push(sample(raw));
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
        FromBoard::Samples(SampleBatch { sequence, samples: core::mem::take(&mut self.samples) })
    }
}

/// The wire's form of a sample.
fn sample<const N: usize>(raw: &RawSample<N>) -> Sample {
    let outputs = &raw.outputs;
    let mut deflections = Vec::<f32, MAX_MESHES>::new();
    for &deflection in outputs.deflections.iter().flatten() {
        let _ = deflections.push(deflection);
    }
    Sample {
        tick: raw.tick,
        state_digest: raw.state_digest,
        carrier_turns: outputs.carrier_turns,
        carrier_fraction: outputs.carrier_fraction,
        carrier_speed: outputs.carrier_speed,
        motor_offset: outputs.motor_offset,
        link_offset: outputs.link_offset,
        gap: outputs.gap,
        wind_up: outputs.wind_up,
        deflections,
        contacts: contact_bits(outputs.contacts.iter().flatten()),
        computation: raw.computation,
    }
}

/// Two bits a mesh, the first mesh lowest.
fn contact_bits<'a>(contacts: impl DoubleEndedIterator<Item = &'a ContactState>) -> u32 {
    contacts.rev().fold(0, |bits, contact| {
        bits << 2
            | match contact {
                ContactState::Separated => 0,
                ContactState::DriveSide => 1,
                ContactState::BackSide => 2,
            }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_mesh_has_the_lowest_bits() {
        use ContactState::{BackSide, DriveSide, Separated};
        assert_eq!(contact_bits([DriveSide, Separated, BackSide].iter()), 0b10_00_01);
    }

    #[test]
    fn batches_are_numbered_without_gaps_and_come_out_empty_again() {
        let mut batcher = Batcher::<3>::default();
        for sequence in 0..3 {
            assert!(matches!(batcher.take(), FromBoard::Samples(batch) if batch.sequence == sequence));
            assert!(batcher.is_empty());
        }
    }
}

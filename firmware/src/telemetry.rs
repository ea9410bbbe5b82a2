//! Samples of the plant, as the tick provides them and in wire form.

use heapless::Vec;
use link::messages::{FromBoard, MAX_MESHES, SAMPLES_PER_BATCH, Sample, SampleBatch};
use model_core::gears::Outputs;
use parameters::ContactState;

use crate::protocol::WireForm;

/// Motion after a step.
#[derive(Debug, Clone, PartialEq)]
pub struct RawSample<const N: usize> {
    /// Steps done since the reset.
    pub tick: u32,
    /// Running digest over every state so far.
    pub state_digest: u64,
    /// Outputs of the model.
    pub outputs: Outputs<f32, N>,
    /// Computation time of the step [timer counts].
    pub computation: u16,
}

/// Wire form of the plant's samples.
pub struct PlantForm<const N: usize>;

impl<const N: usize> WireForm<SAMPLES_PER_BATCH> for PlantForm<N> {
    type Raw = RawSample<N>;
    type Wire = Sample;

    fn wire(raw: &RawSample<N>) -> Sample {
        sample(raw)
    }

    fn message(sequence: u16, samples: Vec<Sample, SAMPLES_PER_BATCH>) -> FromBoard {
        FromBoard::Samples(SampleBatch { sequence, samples })
    }
}

/// Converts a sample to its wire form.
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

/// Contact states, two bits per mesh, the first mesh in the lowest bits.
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
    fn first_mesh_in_lowest_bits() {
        use ContactState::{BackSide, DriveSide, Separated};
        assert_eq!(contact_bits([DriveSide, Separated, BackSide].iter()), 0b10_00_01);
    }
}

//! Motions for a comparison bit for bit: a long one in which torques swing the joint through its gap, with rests; a
//! second one that ends in non-finite numbers; and many short ones that start from the smallest numbers.

use core::array;

use model_core::gears::{Model, Outputs, Relative, State, Tables, Torques};
use model_core::numbers::digest::{self, chain};

use crate::random::Random;
use crate::torque::{NONE, TorqueScale};

/// Steps of the long motion.
pub const STEPS: u32 = 100_000;
/// Steps of the motion that ends in non-finite numbers.
const SHORT: u32 = 2000;
/// First step of the short motion whose torque is infinite.
const UNBOUNDED_FROM: u32 = 1900;
/// Interval between rests without torque [steps].
const REST_EVERY: u32 = 25_000;
/// Length of a rest [steps].
const REST: u32 = 12_000;
/// Halvings from which short motions start: 2^-20 down past the smallest number of f32, 2^-149.
const HALVINGS: core::ops::Range<u32> = 20..152;
/// Steps of a short motion.
const BRIEF: u32 = 20;
/// Longest time of a constant torque [steps].
const LONGEST_HOLD: u32 = 400;
/// Bits of the smallest normal number of f32.
const FIRST_NORMAL: u32 = 1 << 23;

/// Digests of a joint's motions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Digests {
    /// Digest of state and outputs at every step of the long motion.
    pub long: u64,
    /// Digest of the state at every step of the motion with infinite torques.
    pub unbounded: u64,
    /// Digest of the state at every step of the motions from tiny numbers.
    pub tiny: u64,
    /// Number of steps of the long motion that change the contact set.
    pub changes: u32,
}

/// Runs all motions of a joint.
pub fn digests<const N: usize>(tables: &Tables<f32, N>) -> Digests {
    let (long, changes) = long_motion(tables);
    Digests { long, unbounded: unbounded_motion(tables), tiny: tiny_motion(tables), changes }
}

fn long_motion<const N: usize>(tables: &Tables<f32, N>) -> (u64, u32) {
    let (mut generator, mut model) = (RandomTorques::new(tables), Model::new(tables));
    let mut contacts = model.outputs().contacts;
    let (mut running, mut changes) = (digest::START, 0);
    for step in 0..STEPS {
        let resting = step % REST_EVERY >= REST_EVERY - REST;
        model.step(if resting { NONE } else { generator.torques() });
        let outputs = model.outputs();
        changes += u32::from(outputs.contacts != contacts);
        contacts = outputs.contacts;
        running = chain_outputs(chain(running, model.state_digest()), &outputs);
    }
    (running, changes)
}

fn unbounded_motion<const N: usize>(tables: &Tables<f32, N>) -> u64 {
    let (mut generator, mut model) = (RandomTorques::new(tables), Model::new(tables));
    let mut running = digest::START;
    for step in 0..SHORT {
        let torques = generator.torques();
        model.step(if step < UNBOUNDED_FROM { torques } else { Torques { drive: f32::INFINITY, ..torques } });
        running = chain(running, model.state_digest());
    }
    running
}

fn tiny_motion<const N: usize>(tables: &Tables<f32, N>) -> u64 {
    let mut model = Model::new(tables);
    let mut random = Random::new(2);
    let (mut running, mut size) = (digest::START, 1.0_f32);
    for halving in 0..HALVINGS.end {
        // At the end by whole numbers: a mode that flushes tiny numbers must not choose where the motions start.
        size = if size.to_bits() > FIRST_NORMAL { 0.5 * size } else { f32::from_bits(size.to_bits() >> 1) };
        if halving < HALVINGS.start {
            continue;
        }
        let mut any = || f32::from_bits(size.to_bits() | (u32::from(random.below(2) == 1) << 31));
        let mut relative = || Relative { planets: array::from_fn(|_| any()), gap: any(), wind_up: any() };
        model.set_state(State { position: relative(), rate: relative(), ..State::REST });
        let torques = Torques { drive: any(), load: any() };
        for _ in 0..BRIEF {
            model.step(torques);
            running = chain(running, model.state_digest());
        }
    }
    running
}

fn chain_outputs<const N: usize>(running: u64, outputs: &Outputs<f32, N>) -> u64 {
    let shafts = [outputs.carrier_speed, outputs.motor_offset, outputs.link_offset, outputs.gap, outputs.wind_up];
    shafts.iter().chain(outputs.deflections.iter().flatten()).fold(running, |digest, value| {
        let bits: u32 = value.to_bits();
        chain(digest, bits.into())
    })
}

/// Torques that change at random times.
struct RandomTorques {
    random: Random,
    size: TorqueScale,
    torques: Torques<f32>,
    left: u32,
}

impl RandomTorques {
    fn new<const N: usize>(tables: &Tables<f32, N>) -> Self {
        Self { random: Random::new(1), size: TorqueScale::of(tables), torques: NONE, left: 0 }
    }

    fn torques(&mut self) -> Torques<f32> {
        if self.left == 0 {
            self.left = 1 + self.random.below(LONGEST_HOLD);
            self.torques = self.size.any(&mut self.random);
        }
        self.left -= 1;
        self.torques
    }
}

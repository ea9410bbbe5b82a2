//! A long motion that loses and finds contact, for a comparison bit for bit: torques swing the joint through its gap,
//! rests let what is damped die away to the smallest numbers, and a second motion ends in numbers that are none. How
//! the digests are compared is left to whoever runs them.

use model_core::digest::{self, chain};
use model_core::realtime::{Model, Outputs, Torques};
use model_core::tables::Tables;

use crate::numbers::Numbers;

/// Steps of the long motion.
pub const STEPS: u32 = 100_000;
/// Steps of the motion that ends badly.
const SHORT: u32 = 2000;
/// First step of the short motion whose torque is infinite.
const UNBOUNDED_FROM: u32 = 1900;
/// Every so often, in steps, the joint is left alone ...
const REST_EVERY: u32 = 25_000;
/// ... for so long: rates die away to below the smallest number that f32 holds.
const REST: u32 = 12_000;
/// Torques last up to so many steps.
const LONGEST_HOLD: u32 = 400;
/// Acceleration of the sun, in units of b_c omega_n^2, that the torques go up to: some half-backlashes of deflection.
const STRENGTH: f32 = 20.0;

/// Digests of a joint's motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digests {
    /// Of state and outputs at every step of the long motion.
    pub long: u64,
    /// Of the state at every step of the motion that ends in infinite torques.
    pub unbounded: u64,
    /// Steps of the long motion after which the contact set is another than before.
    pub changes: u32,
}

/// Both motions of a joint, from rest.
pub fn digests<const N: usize>(tables: &Tables<f32, N>) -> Digests {
    let mut hand = Hand::new(tables);
    let mut model = Model::new(tables);
    let mut contacts = model.outputs().contacts;
    let (mut long, mut changes) = (digest::START, 0);
    for step in 0..STEPS {
        let resting = step % REST_EVERY >= REST_EVERY - REST;
        model.step(if resting { Torques { drive: 0.0, load: 0.0 } } else { hand.torques() });
        let outputs = model.outputs();
        changes += u32::from(outputs.contacts != contacts);
        contacts = outputs.contacts;
        long = chain_outputs(chain(long, model.state_digest()), &outputs);
    }

    let mut hand = Hand::new(tables);
    model.reset();
    let mut unbounded = digest::START;
    for step in 0..SHORT {
        let torques = hand.torques();
        model.step(if step < UNBOUNDED_FROM { torques } else { Torques { drive: f32::INFINITY, ..torques } });
        unbounded = chain(unbounded, model.state_digest());
    }
    Digests { long, unbounded, changes }
}

fn chain_outputs<const N: usize>(running: u64, outputs: &Outputs<f32, N>) -> u64 {
    let shafts = [outputs.carrier_speed, outputs.motor_offset, outputs.link_offset, outputs.gap, outputs.wind_up];
    shafts.iter().chain(outputs.deflections.iter().flatten()).fold(running, |digest, value| {
        let bits: u32 = value.to_bits();
        chain(digest, bits.into())
    })
}

/// Torques that change by chance, with the load about what balances the drive.
struct Hand {
    numbers: Numbers,
    strength: f32,
    balance: f32,
    torques: Torques<f32>,
    left: u32,
}

impl Hand {
    fn new<const N: usize>(tables: &Tables<f32, N>) -> Self {
        Self {
            numbers: Numbers::new(1),
            strength: STRENGTH / tables.units.drive,
            balance: tables.rigid.drive / tables.rigid.load,
            torques: Torques { drive: 0.0, load: 0.0 },
            left: 0,
        }
    }

    fn torques(&mut self) -> Torques<f32> {
        if self.left == 0 {
            self.left = 1 + self.numbers.below(LONGEST_HOLD);
            let drive = self.strength * self.numbers.signed();
            let load = self.balance * drive * (1.0 + 0.5 * self.numbers.signed());
            self.torques = Torques { drive, load };
        }
        self.left -= 1;
        self.torques
    }
}

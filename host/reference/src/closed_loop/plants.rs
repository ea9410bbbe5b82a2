//! Random plants about a joint: what the true one may have and its controller does not know. The controller is always
//! designed for the joint as named.

use parameters::JointParameters;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::drive_train::DriveTrainParameters;

/// A true plant and how wrong the guess of its width is.
#[derive(Debug, Clone)]
pub struct Variation {
    /// The true joint.
    pub joint: JointParameters,
    /// The true surroundings.
    pub train: DriveTrainParameters,
    /// Guessed over true half-backlash.
    pub width_factor: f64,
}

/// Draws a plant: half-backlash 20 to 60 um, its guess wrong by up to 50 %, torque constant by 2 %, compliance 1.5 to 6
/// N m/arcmin, current lag 0.2 to 0.6 ms.
pub fn random_plant(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Variation {
    let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_add(0x5eed));
    let mut within =
        |from: f64, to: f64| from + (to - from) * ((random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64);
    let mut joint = joint.clone();
    let mut train = train.clone();
    let half_backlash = within(20e-6, 60e-6);
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash.iter_mut().for_each(|value| *value = half_backlash);
    }
    let width_factor = within(0.5, 1.5);
    train.surroundings.torque_constant_error_ratio = within(-0.02, 0.02);
    if let Some(compliance) = joint.compliance.as_mut() {
        compliance.stiffness = within(1.5, 6.0) / (1.0_f64 / 60.0).to_radians();
    }
    train.surroundings.current_lag = within(0.2e-3, 0.6e-3);
    Variation { joint, train, width_factor }
}

//! Random numbers of a drive train: one seed, one stream per effect, so that a new effect leaves the random numbers of
//! the others unchanged.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Noise of the torque.
pub const TORQUE_NOISE: u64 = 0;
/// Noise of the motor encoder.
pub const MOTOR_NOISE: u64 = 1;
/// Noise of the output encoder.
pub const OUTPUT_NOISE: u64 = 2;
/// Age of the motor's readings.
pub const MOTOR_AGE: u64 = 3;
/// Age of the output's readings.
pub const OUTPUT_AGE: u64 = 4;
/// Starts of the control periods.
pub const CONTROL_JITTER: u64 = 5;

/// Returns the random stream of an effect.
pub fn stream(seed: u64, effect: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(effect);
    random
}

/// Returns a number between 0 and 1, both excluded, with 53 random bits.
pub fn uniform(random: &mut ChaCha8Rng) -> f64 {
    ((random.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// Returns a standard normal deviate, by Box and Muller.
pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, turn) = ((-2.0 * uniform(random).ln()).sqrt(), uniform(random));
    radius * (TAU * turn).cos()
}

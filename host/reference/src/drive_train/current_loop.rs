//! Model from the torque command to the air-gap torque: delay, limit, resolution, lag, saturation, ripple, wrong torque
//! constant, noise. Electrical dynamics beyond one first-order lag are neglected.
//!
//! With the torque T after the lag, the limit L, the error k of the torque constant, the loss a at the limit, the
//! ripple amplitude r with N periods per motor turn, the noise n and its ratio, the air-gap torque is
//!
//! ```text
//! T (1 - a min(1, (T / L)^2)) (1 + k) (1 + r sin(N theta_m)) (1 + ratio n)   (M1)
//! ```
//!
//! Iron saturation makes the flux grow less than the current; its first term is odd and cubic in the current (J. R.
//! Hendershot, T. J. E. Miller, "Design of brushless permanent-magnet motors"). Commands are rounded to multiples of
//! resolution x L.
//!
//! Equations: (R6) in docs/theory/real-joints.md.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use parameters::Surroundings;
use rand_chacha::ChaCha8Rng;

use super::random::{self, normal};

/// Delayed command.
#[derive(Debug, Clone, Copy)]
struct Command {
    acts_from: u64,
    torque: f64,
}

/// Motor up to its air gap. Parts of a period are counted as integers, so that no rounding error adds up.
#[derive(Debug, Clone)]
pub(super) struct CurrentLoop {
    around: Surroundings,
    pending: VecDeque<Command>,
    wanted: f64,
    current: f64,
    noise: f64,
    random: ChaCha8Rng,
}

impl CurrentLoop {
    pub fn new(around: Surroundings, seed: u64) -> Self {
        Self {
            around,
            pending: VecDeque::new(),
            wanted: 0.0,
            current: 0.0,
            noise: 0.0,
            random: random::stream(seed, random::TORQUE_NOISE),
        }
    }

    /// Takes a command that acts from a given part on, and draws the noise of this period.
    pub fn command(&mut self, torque: f64, acts_from: u64) {
        let limit = self.around.torque_limit;
        let step = self.around.torque_errors.resolution_ratio * limit;
        let torque = torque.clamp(-limit, limit);
        let torque = if step > 0.0 { step * (torque / step).round() } else { torque };
        self.pending.push_back(Command { acts_from, torque });
        self.noise = normal(&mut self.random);
    }

    /// Mean air-gap torque over a part of this length [s] at a motor angle [rad]; exact if the command is constant
    /// within the part [N m].
    pub fn torque(&mut self, part: u64, length: f64, motor_angle: f64) -> f64 {
        while let Some(command) = self.pending.front().filter(|command| command.acts_from <= part) {
            self.wanted = command.torque;
            self.pending.pop_front();
        }
        let mean = if self.around.current_lag > 0.0 {
            let ratio = length / self.around.current_lag;
            let decay = -(-ratio).exp_m1();
            let lacking = self.wanted - self.current;
            self.current += lacking * decay;
            self.wanted - lacking * decay / ratio
        } else {
            self.current = self.wanted;
            self.wanted
        };
        let errors = &self.around.torque_errors;
        let flux = if errors.saturation_ratio > 0.0 {
            1.0 - errors.saturation_ratio * (mean / self.around.torque_limit).powi(2).min(1.0)
        } else {
            1.0
        };
        let ripple = if errors.ripple_ratio > 0.0 {
            1.0 + errors.ripple_ratio * (f64::from(errors.ripple_periods_per_turn) * motor_angle.rem_euclid(TAU)).sin()
        } else {
            1.0
        };
        let given = mean * flux * ripple;
        given * (1.0 + self.around.torque_constant_error_ratio) * (1.0 + self.around.torque_noise_ratio * self.noise)
    }
}

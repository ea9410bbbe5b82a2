//! From a torque command to the torque in the air gap: delay, limit, lag, wrong torque constant, noise. Electrical
//! dynamics beyond one first-order lag are left out.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use parameters::Surroundings;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A command on its way.
#[derive(Debug, Clone, Copy)]
struct Command {
    acts_from: u64,
    torque: f64,
}

/// The motor up to its air gap. Parts of time are counted, never added up.
#[derive(Debug, Clone)]
pub(super) struct CurrentLoop {
    around: Surroundings,
    part: f64,
    pending: VecDeque<Command>,
    wanted: f64,
    current: f64,
    noise: f64,
    random: ChaCha8Rng,
}

impl CurrentLoop {
    pub fn new(around: Surroundings, part: f64, seed: u64) -> Self {
        Self {
            around,
            part,
            pending: VecDeque::new(),
            wanted: 0.0,
            current: 0.0,
            noise: 0.0,
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// Takes a command that will act from a part of time on, and draws the noise of this period.
    pub fn command(&mut self, torque: f64, acts_from: u64) {
        let limit = self.around.torque_limit;
        self.pending.push_back(Command { acts_from, torque: torque.clamp(-limit, limit) });
        self.noise = self.normal();
    }

    /// Mean torque in the air gap during a part of time: exact for a command that does not change within it [N m].
    pub fn torque(&mut self, part: u64) -> f64 {
        while let Some(command) = self.pending.front().filter(|command| command.acts_from <= part) {
            self.wanted = command.torque;
            self.pending.pop_front();
        }
        let mean = if self.around.current_lag > 0.0 {
            let ratio = self.part / self.around.current_lag;
            let decay = -(-ratio).exp_m1();
            let lacking = self.wanted - self.current;
            self.current += lacking * decay;
            self.wanted - lacking * decay / ratio
        } else {
            self.current = self.wanted;
            self.wanted
        };
        mean * (1.0 + self.around.torque_constant_error_ratio) * (1.0 + self.around.torque_noise_ratio * self.noise)
    }

    /// A standard normal deviate, by Box and Muller.
    fn normal(&mut self) -> f64 {
        // 53 random bits; the first is kept off zero for the logarithm.
        let mut uniform = || ((self.random.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
        let (radius, turn) = ((-2.0 * uniform().ln()).sqrt(), uniform());
        radius * (TAU * turn).cos()
    }
}

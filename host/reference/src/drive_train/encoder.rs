//! Absolute encoder: past angles, errors, counts.
//!
//! With the shaft angle theta, amplitudes and phases of the errors, C counts and N scale periods per turn, the standard
//! deviation sigma of the noise and a standard normal deviate n, a reading is
//!
//! ```text
//! counts = floor(C / 2 pi (theta + e_1 sin(theta + p_1) + e_2 sin(2 theta + p_2)
//!                               + s_1 sin(N theta + q_1) + s_2 sin(2 N theta + q_2)) + sigma n)   (E1)
//! ```
//!
//! s_1 and s_2 are the interpolation errors caused by offsets and unequal amplitudes of the sine and cosine of a scale
//! (P. L. M. Heydemann, "Determination and correction of quadrature fringe measurement errors in interferometers",
//! Applied Optics 20, 1981). theta is the angle at the time of the reading, less the skew and an age that is drawn for
//! each reading, uniformly from 0 to the age jitter.
//!
//! Equations: (R7) in docs/theory/real-joints.md.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use parameters::AbsoluteEncoder;
use rand_chacha::ChaCha8Rng;

use super::parameters::ErrorPhases;
use super::random::{self, normal, uniform};

#[derive(Debug, Clone, Copy)]
struct Point {
    time: f64,
    angle: f64,
    speed: f64,
}

/// Encoder with the past angles that its skew requires.
#[derive(Debug, Clone)]
pub(super) struct Encoder {
    parameters: AbsoluteEncoder,
    phases: ErrorPhases,
    subdivision_phases: [f64; 2],
    past: VecDeque<Point>,
    ages: ChaCha8Rng,
    noises: ChaCha8Rng,
    /// Random age of the present reading [s].
    age: f64,
    /// Noise of the present reading [counts].
    noise: f64,
}

/// Place of an encoder; selects its random stream.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    Motor,
    Output,
}

impl Encoder {
    pub fn new(
        parameters: AbsoluteEncoder,
        phases: ErrorPhases,
        subdivision_phases: [f64; 2],
        place: Place,
        seed: u64,
    ) -> Self {
        let (ages, noises) = match place {
            Place::Motor => (random::MOTOR_AGE, random::MOTOR_NOISE),
            Place::Output => (random::OUTPUT_AGE, random::OUTPUT_NOISE),
        };
        let mut encoder = Self {
            parameters,
            phases,
            subdivision_phases,
            past: VecDeque::new(),
            ages: random::stream(seed, ages),
            noises: random::stream(seed, noises),
            age: 0.0,
            noise: 0.0,
        };
        encoder.begin_reading();
        encoder
    }

    /// Draws age and noise of a new reading.
    pub fn begin_reading(&mut self) {
        self.age = self.parameters.age_jitter * uniform(&mut self.ages);
        self.noise = self.parameters.noise_counts * normal(&mut self.noises);
    }

    /// Records the shaft's angle and speed; times must rise.
    pub fn note(&mut self, time: f64, angle: f64, speed: f64) {
        self.past.push_back(Point { time, angle, speed });
        let oldest = self.parameters.skew + self.parameters.age_jitter;
        // Keeps one point at or before the time of the reading, and all later points.
        while self.past.len() > 2 && self.past[1].time <= time - oldest {
            self.past.pop_front();
        }
    }

    /// Returns counts since angle zero, whole turns included.
    pub fn counts(&self) -> i64 {
        let angle = self.delayed_angle();
        let once = self.parameters.once_per_turn_error * (angle + self.phases.once_per_turn).sin();
        let twice = self.parameters.twice_per_turn_error * (2.0 * angle + self.phases.twice_per_turn).sin();
        let of_scale = self.parameters.subdivision;
        let periods = f64::from(of_scale.periods_per_turn);
        let [first, second] = self.subdivision_phases;
        let within_period =
            of_scale.first * (periods * angle + first).sin() + of_scale.second * (2.0 * periods * angle + second).sin();
        let counts_per_turn = self.parameters.counts_per_turn as f64;
        ((angle + once + twice + within_period) / TAU * counts_per_turn + self.noise).floor() as i64
    }

    /// Angle at the time of the reading, by a cubic between the two nearest points.
    fn delayed_angle(&self) -> f64 {
        let Some(last) = self.past.back() else { return 0.0 };
        let then = last.time - self.parameters.skew - self.age;
        let after = self.past.partition_point(|point| point.time <= then);
        let (Some(from), Some(to)) =
            (after.checked_sub(1).and_then(|index| self.past.get(index)), self.past.get(after))
        else {
            // Without skew: the last point. Before the start: the start angle.
            return if after == 0 { self.past[0].angle } else { last.angle };
        };
        let width = to.time - from.time;
        let fraction = (then - from.time) / width;
        let rest = 1.0 - fraction;
        from.angle * rest * rest * (1.0 + 2.0 * fraction)
            + to.angle * fraction * fraction * (1.0 + 2.0 * rest)
            + width * fraction * rest * (from.speed * rest - to.speed * fraction)
    }
}

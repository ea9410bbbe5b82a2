//! Cogging of the motor (O17): a torque with a known number of periods per motor turn, and unknown amplitude and phase.
//!
//! The motor side does not model cogging, so that the load torque contains its negative while a flank carries and the
//! motor turns. With theta the cogging phase, w its rate, F the response of the load side, and H = j w t / (1 + j w t)
//! a high-pass filter, applied twice:
//!
//! ```text
//! load torque, less slow parts = - F(j w) H(j w)^2 applied to (a sin theta + b cos theta) + noise
//! ```
//!
//! A Kalman filter with two states estimates a and b while the motor's speed is steady. The noise is correlated over a
//! few intervals; its variance is estimated as well.

use super::thresholds::OUTLIER;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::numbers::state_words::state_words;
use crate::observer::tables::CoggingTable;

/// Estimate of the cogging.
#[derive(Debug, Clone, Copy)]
pub struct Cogging<T: Real> {
    /// Sine and cosine of the driving torque, referred to the link [N m].
    torque: [T; 2],
    /// Variances of sine and cosine, then their covariance [N^2 m^2].
    variance: [T; 3],
    /// Mean square of the innovation [N^2 m^2].
    noise: T,
    /// Slow part of the load torque, then of the remainder [N m].
    slow: [T; 2],
    /// Slow part of the motor's speed [rad/s].
    speed: T,
    /// Carrying flank, and the intervals since it began to carry.
    flank: Option<Flank>,
    carrying_intervals: u32,
}
state_words! { struct Cogging<T> { torque, variance, noise, slow, speed, flank, carrying_intervals } }

impl<T: Real> Cogging<T> {
    pub fn new(table: &CoggingTable<T>) -> Self {
        Self {
            torque: [T::ZERO; 2],
            variance: [table.prior, table.prior, T::ZERO],
            noise: table.prior,
            slow: [T::ZERO; 2],
            speed: T::ZERO,
            flank: None,
            carrying_intervals: 0,
        }
    }

    /// Estimated sine and cosine of the driving torque, referred to the link [N m].
    pub fn torque(&self) -> [T; 2] {
        self.torque
    }

    /// Updates the estimate once per learning interval from the motor's place in its turn [turns], its speed [rad/s],
    /// the load torque [N m] and the flank of settled contact.
    pub fn update(&mut self, table: &CoggingTable<T>, [place, speed, load]: [T; 3], flank: Option<Flank>) {
        if flank.is_none() || flank != self.flank {
            (self.flank, self.carrying_intervals, self.slow, self.speed) = (flank, 0, [load, T::ZERO], speed);
            return;
        }
        self.carrying_intervals = self.carrying_intervals.saturating_add(1);
        let [first, second] = &mut self.slow;
        let fast = load - *first;
        *first += table.slow * fast;
        let faster = fast - *second;
        *second += table.slow * faster;
        self.speed += table.steady * (speed - self.speed);
        let [min_speed, max_speed] = table.speeds;
        let steady = (speed - self.speed).abs() < table.unsteady * speed.abs();
        if self.carrying_intervals >= table.settled_after
            && steady
            && speed.abs() > min_speed
            && speed.abs() < max_speed
        {
            self.correct(table, -faster, load_regressors(table, place, speed));
        }
    }

    /// Updates the Kalman filter with a torque [N m] and its regressors for sine and cosine.
    fn correct(&mut self, table: &CoggingTable<T>, driving: T, [sine, cosine]: [T; 2]) {
        let [a, b] = self.torque;
        let [of_a, of_b, of_both] = self.variance;
        let (from_a, from_b) = (of_a * sine + of_both * cosine, of_both * sine + of_b * cosine);
        let innovation = driving - a * sine - b * cosine;
        let (square, uncertain) = (innovation * innovation, sine * from_a + cosine * from_b);
        if square > T::from_i32(OUTLIER.cogging_sigma * OUTLIER.cogging_sigma) * (self.noise + uncertain) {
            return;
        }
        let expected = table.repeats * self.noise + uncertain;
        self.noise += table.memory * (square - self.noise);
        if expected > T::ZERO {
            let [gain_a, gain_b] = [from_a, from_b].map(|from| from / expected);
            self.torque =
                [a + gain_a * innovation, b + gain_b * innovation].map(|it| clamp(it, -table.limit, table.limit));
            self.variance = [of_a - gain_a * from_a, of_b - gain_b * from_b, of_both - gain_a * from_b];
        }
    }
}

/// Regressors of a high-pass filtered load torque for sine and cosine [-].
fn load_regressors<T: Real>(table: &CoggingTable<T>, place: T, speed: T) -> [T; 2] {
    let phase = (place / T::PHASE_UNIT).to_phase().wrapping_mul(table.periods);
    let (sine, cosine) = sine_cosine::<T>(phase.wrapping_sub((table.late * speed).to_phase()));
    let ([first, second, third], square) = (table.response, speed * speed);
    let of_load = [T::ONE - square * second, speed * (first - square * third)];
    let tangent = speed * table.slow_time;
    let of_slow = [T::ONE - tangent * tangent, T::TWO * tangent];
    // 1/F times (1 + j w t)^2 is nonzero at every speed: F and H have no pole on the imaginary axis.
    let real = of_load[0] * of_slow[0] - of_load[1] * of_slow[1];
    let imaginary = of_load[0] * of_slow[1] + of_load[1] * of_slow[0];
    let part = -((tangent * tangent) / (real * real + imaginary * imaginary));
    [part * (real * sine - imaginary * cosine), part * (real * cosine + imaginary * sine)]
}

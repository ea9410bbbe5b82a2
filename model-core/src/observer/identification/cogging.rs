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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::Q1_DOUBLE;

    /// Table of Q1: learning intervals of 1 ms, ripple of 0.02 N m at the motor, 0.12 N m at the link.
    fn q1() -> &'static CoggingTable<f64> {
        &Q1_DOUBLE.cogging
    }

    /// Cogging of a motor that has turned at 1 rad/s on one flank for a second, without a load.
    fn settled() -> Cogging<f64> {
        let table = q1();
        let mut cogging = Cogging::new(table);
        (0..1000).for_each(|_| cogging.update(table, [0.0, 1.0, 0.0], Some(Flank::Drive)));
        cogging
    }

    /// True if an interval at a motor speed updates the estimate of a motor that turned at a speed.
    fn updates(before: f64, speed: f64) -> bool {
        let mut cogging = Cogging { speed: before, ..settled() };
        let variance = cogging.variance;
        cogging.update(q1(), [0.0, speed, 0.0], Some(Flank::Drive));
        cogging.variance != variance
    }

    #[test]
    fn slow_load_is_removed_in_20_ms() {
        let mut cogging = settled();
        (0..20).for_each(|_| cogging.update(q1(), [0.0, 1.0, 1.0], Some(Flank::Drive)));
        assert!((cogging.slow[0] - 0.632).abs() < 1e-3, "{}", cogging.slow[0]);
    }

    #[test]
    fn slow_cogging_is_not_estimated() {
        // 84 periods per turn advance by 0.6 rad in 20 ms at 0.357 rad/s.
        assert!(!updates(0.35, 0.35) && updates(0.36, 0.36) && updates(-0.36, -0.36));
    }

    #[test]
    fn fast_cogging_is_not_estimated() {
        // 84 periods per turn advance by 1 rad in 1 ms at 11.9 rad/s.
        assert!(updates(11.8, 11.8) && !updates(12.0, 12.0) && !updates(-12.0, -12.0));
    }

    #[test]
    fn speed_is_averaged_over_50_ms() {
        let mut cogging = Cogging { speed: 0.0, ..settled() };
        (0..50).for_each(|_| cogging.update(q1(), [0.0, 1.0, 0.0], Some(Flank::Drive)));
        assert!((cogging.speed - 0.632).abs() < 1e-3, "{}", cogging.speed);
    }

    #[test]
    fn unsteady_speed_is_not_used() {
        // 2 % of the difference are averaged before the comparison with 30 % of the speed.
        assert!(updates(0.70, 1.0) && !updates(0.69, 1.0) && updates(1.30, 1.0) && !updates(1.31, 1.0));
    }

    #[test]
    fn contact_settles_for_20_intervals() {
        let table = q1();
        let is_updated = |intervals: u32| {
            let mut cogging = Cogging::new(table);
            // The first interval on the flank begins the time.
            (0..=intervals).for_each(|_| cogging.update(table, [0.0, 1.0, 0.0], Some(Flank::Back)));
            cogging.variance != Cogging::new(table).variance
        };
        assert!(!is_updated(19) && is_updated(20));
    }

    #[test]
    fn five_intervals_count_as_one_measurement() {
        let mut cogging = Cogging::new(q1());
        // Prior and noise are alike: one measurement of five intervals weighs one sixth.
        cogging.correct(q1(), 0.06, [1.0, 0.0]);
        assert!((cogging.torque[0] - 0.01).abs() < 1e-9, "{}", cogging.torque[0]);
    }

    #[test]
    fn cogging_is_at_most_three_ripples() {
        let mut cogging = Cogging::new(q1());
        (0..200).for_each(|_| cogging.correct(q1(), 0.4, [1.0, 0.0]));
        assert!((cogging.torque[0] - 0.36).abs() < 1e-9, "{}", cogging.torque[0]);
    }

    #[test]
    fn noise_is_averaged_over_100_ms() {
        let mut cogging = Cogging { torque: [0.0; 2], variance: [0.0; 3], noise: 1.0, ..Cogging::new(q1()) };
        (0..100).for_each(|_| cogging.correct(q1(), 0.0, [1.0, 0.0]));
        assert!((cogging.noise - 0.368).abs() < 1e-3, "{}", cogging.noise);
    }
}

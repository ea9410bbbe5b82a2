//! The motor's cogging: a torque that repeats a known number of times in a turn of the motor, of unknown size and phase.
//!
//! The motor side does not know of it, so that the load torque has it in reverse while a flank carries and the motor turns. With
//! theta the cogging phase, w its rate, F the response of the load side, and H that of taking the slow part out, twice over
//! (H = j w t / (1 + j w t)):
//!
//! ```text
//! load torque, less slow parts = - F(j w) H(j w)^2 applied to (a sin theta + b cos theta) + noise
//! ```
//!
//! a and b are learnt by a Kalman filter for two numbers, while the motor's speed is steady. Noise says the same for a few
//! intervals, and its size is measured on the way.

use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::observer::tables::CoggingTable;

/// Normalised innovation beyond which it is something else than noise [standard deviations].
const GATE: i32 = 5;

/// Sine and cosine of the cogging, and what they are learnt with.
#[derive(Debug, Clone, Copy)]
pub struct Cogging<T: Real> {
    /// What drives, referred to the link [N m].
    torque: [T; 2],
    /// Variances of both, then their covariance [N^2 m^2].
    variance: [T; 3],
    /// Mean square of what is left [N^2 m^2].
    noise: T,
    /// Slow part of the load torque, then of the rest [N m].
    slow: [T; 2],
    /// Slow part of the motor's speed [rad/s].
    speed: T,
    /// The flank that carries, and for how many intervals it has.
    flank: Option<Flank>,
    carried_for: u32,
}

impl<T: Real> Cogging<T> {
    pub fn new(table: &CoggingTable<T>) -> Self {
        Self {
            torque: [T::ZERO; 2],
            variance: [table.prior, table.prior, T::ZERO],
            noise: table.prior,
            slow: [T::ZERO; 2],
            speed: T::ZERO,
            flank: None,
            carried_for: 0,
        }
    }

    /// Sine and cosine of the torque that drives, referred to the link, as far as they are learnt [N m].
    pub fn torque(&self) -> [T; 2] {
        self.torque
    }

    /// Once a learning interval: where the motor is in its turn [turns], how fast it turns [rad/s], what brakes the link [N m],
    /// and on which flank contact has settled.
    pub fn learn(&mut self, table: &CoggingTable<T>, [place, speed, load]: [T; 3], flank: Option<Flank>) {
        if flank.is_none() || flank != self.flank {
            (self.flank, self.carried_for, self.slow, self.speed) = (flank, 0, [load, T::ZERO], speed);
            return;
        }
        self.carried_for = self.carried_for.saturating_add(1);
        let [first, second] = &mut self.slow;
        let fast = load - *first;
        *first += table.slow * fast;
        let faster = fast - *second;
        *second += table.slow * faster;
        self.speed += table.steady * (speed - self.speed);
        let [least, most] = table.speeds;
        let steady = (speed - self.speed).abs() < table.unsteady * speed.abs();
        if self.carried_for >= table.settled_after && steady && speed.abs() > least && speed.abs() < most {
            self.update(table, -faster, seen(table, place, speed));
        }
    }

    /// The Kalman filter's step: a torque [N m] that shows so much of sine and of cosine.
    fn update(&mut self, table: &CoggingTable<T>, driving: T, [sine, cosine]: [T; 2]) {
        let [a, b] = self.torque;
        let [of_a, of_b, of_both] = self.variance;
        let (from_a, from_b) = (of_a * sine + of_both * cosine, of_both * sine + of_b * cosine);
        let innovation = driving - a * sine - b * cosine;
        let (square, uncertain) = (innovation * innovation, sine * from_a + cosine * from_b);
        if square > T::from_i32(GATE * GATE) * (self.noise + uncertain) {
            return;
        }
        let expected = table.repeats * self.noise + uncertain;
        self.noise += table.memory * (square - self.noise);
        if expected > T::ZERO {
            let [gain_a, gain_b] = [from_a, from_b].map(|from| from.over(expected));
            self.torque =
                [a + gain_a * innovation, b + gain_b * innovation].map(|it| clamp(it, -table.limit, table.limit));
            self.variance = [of_a - gain_a * from_a, of_b - gain_b * from_b, of_both - gain_a * from_b];
        }
    }
}

/// What a load torque less its slow parts shows of sine and of cosine [-].
fn seen<T: Real>(table: &CoggingTable<T>, place: T, speed: T) -> [T; 2] {
    let phase = place.over(T::PHASE_UNIT).to_phase().wrapping_mul(table.periods);
    let (sine, cosine) = sine_cosine::<T>(phase.wrapping_sub((table.late * speed).to_phase()));
    let ([first, second, third], square) = (table.response, speed * speed);
    let of_load = [T::ONE - square * second, speed * (first - square * third)];
    let tangent = speed * table.slow_time;
    let of_slow = [T::ONE - tangent * tangent, T::TWO * tangent];
    // 1 / F times (1 + j w t)^2, which is 0 at no speed: neither has a pole on the imaginary axis.
    let real = of_load[0] * of_slow[0] - of_load[1] * of_slow[1];
    let imaginary = of_load[0] * of_slow[1] + of_load[1] * of_slow[0];
    let part = -(tangent * tangent).over(real * real + imaginary * imaginary);
    [part * (real * sine - imaginary * cosine), part * (real * cosine + imaginary * sine)]
}

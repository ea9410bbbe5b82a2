//! What brakes a link, split into a part that does not care for the direction of motion (weight, a push) and dry friction, which
//! changes its sign with it: a Kalman filter with two states. Which of both a link is braked by shows only once it has moved both ways.
//!
//! Symbols: g even part and f friction [N m], s direction from -1 to 1, h = (1, s), P covariance of (g, f), r variance of a reading.
//! A reading z of g + s f gives K = P h / (h P h + r), (g, f) += K (z - g - s f), P -= K h P.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Even part and dry friction, and how well they are known.
#[derive(Debug, Clone)]
pub(super) struct Brakes<T: Real> {
    /// [N m].
    pub even: T,
    /// [N m].
    pub friction: T,
    /// Variances of both and their covariance, in the unit of the readings' variance.
    variance: [T; 3],
}

impl<T: Real> Brakes<T> {
    /// What is known beforehand: friction, and the variances of even part and friction.
    pub fn new(friction: T, [of_even, of_friction]: [T; 2]) -> Self {
        Self { even: T::ZERO, friction, variance: [of_even, of_friction, T::ZERO] }
    }

    /// Torque that brakes a link which moves in a direction.
    pub fn torque(&self, direction: T) -> T {
        self.even + self.friction * direction
    }

    /// Variance of that torque.
    pub fn variance(&self, direction: T) -> T {
        let [even, friction, both] = self.variance;
        even + (T::TWO * both + friction * direction) * direction
    }

    /// Time has passed: even part and friction may be others by now.
    pub fn grow(&mut self, [of_even, of_friction]: [T; 2]) {
        self.variance[0] += of_even;
        self.variance[1] += of_friction;
    }

    /// What was known of the even part holds no longer.
    pub fn doubt_even(&mut self, variance: T) {
        self.variance = [variance, self.variance[1], T::ZERO];
    }

    /// Takes a reading of the torque of a link that moves in a direction. Friction stays within a limit. Returns by how much the even part
    /// has changed.
    pub fn take(&mut self, torque: T, direction: T, noise: T, most_friction: T) -> T {
        let [even, friction, both] = self.variance;
        let (to_even, to_friction) = (even + both * direction, both + friction * direction);
        let total = to_even + to_friction * direction + noise;
        if total <= T::ZERO || !total.is_finite() {
            return T::ZERO;
        }
        let (gain_even, gain_friction) = (to_even.over(total), to_friction.over(total));
        let innovation = torque - self.even - self.friction * direction;
        self.even += gain_even * innovation;
        self.friction = clamp(self.friction + gain_friction * innovation, T::ZERO, most_friction);
        self.variance =
            [even - gain_even * to_even, friction - gain_friction * to_friction, both - gain_even * to_friction];
        gain_even * innovation
    }
}

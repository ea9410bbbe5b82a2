//! Kalman filter with two states, (K6) and (K19): splits the torque that brakes a link into an even load (weight, a push), which does not
//! depend on the direction of motion, and dry friction, which does. Only motion in both directions separates the two.
//!
//! ```text
//! K = P h / (h P h + r),   (L, f) += K (z - L - f dir),   P -= K h P,   h = (1, dir)
//! ```
//!
//! Symbols: L = `even` load and f = `friction` [N m], dir = `direction` from -1 to 1, P = `variance` of (L, f), z = measured `torque`,
//! r = `noise`, the variance of z.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Even load and dry friction with their covariance.
#[derive(Debug, Clone)]
pub(super) struct Brakes<T: Real> {
    /// Even load [N m].
    pub even: T,
    /// Dry friction [N m].
    pub friction: T,
    /// Variances of even load and friction and their covariance, in the unit of the measurement's variance.
    variance: [T; 3],
}

impl<T: Real> Brakes<T> {
    /// Starts from a known friction, and the variances of even load and friction.
    pub fn new(friction: T, [of_even, of_friction]: [T; 2]) -> Self {
        Self { even: T::ZERO, friction, variance: [of_even, of_friction, T::ZERO] }
    }

    /// Torque that brakes a link moving in a direction [N m].
    pub fn torque(&self, direction: T) -> T {
        self.even + self.friction * direction
    }

    /// Variance of [`Self::torque`].
    pub fn variance(&self, direction: T) -> T {
        let [even, friction, both] = self.variance;
        even + (T::TWO * both + friction * direction) * direction
    }

    /// Adds the growth of the variances per period: even load and friction may change.
    pub fn grow(&mut self, [of_even, of_friction]: [T; 2]) {
        self.variance[0] += of_even;
        self.variance[1] += of_friction;
    }

    /// Resets the variance of the even load, whose value no longer holds.
    pub fn doubt_even(&mut self, variance: T) {
        self.variance = [variance, self.variance[1], T::ZERO];
    }

    /// Corrects the state by a measured torque of a link moving in a direction; friction stays within 0 and
    /// `most_friction`. Returns the correction of the even load.
    pub fn take(&mut self, torque: T, direction: T, noise: T, most_friction: T) -> T {
        let [even, friction, both] = self.variance;
        let (to_even, to_friction) = (even + both * direction, both + friction * direction);
        let total = to_even + to_friction * direction + noise;
        if total <= T::ZERO || !total.is_finite() {
            return T::ZERO;
        }
        let (gain_even, gain_friction) = (to_even / total, to_friction / total);
        let innovation = torque - self.even - self.friction * direction;
        self.even += gain_even * innovation;
        self.friction = clamp(self.friction + gain_friction * innovation, T::ZERO, most_friction);
        self.variance =
            [even - gain_even * to_even, friction - gain_friction * to_friction, both - gain_even * to_friction];
        gain_even * innovation
    }
}

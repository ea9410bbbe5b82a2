//! Kalman filter with two states: splits the torque that brakes a link into a gravity torque (weight, a steady push),
//! which does not depend on the direction of motion, and dry friction, which does. Only motion in both directions
//! separates them.
//!
//! ```text
//! (K6), (K19)  K = P h/(h P h + r),   (L, f) += K (z - L - f dir),   P -= K h P,   h = (1, dir)
//! ```
//!
//! Symbols: L, f = `gravity_torque`, `friction`; dir = `direction`, -1 to 1; P = `variance` of (L, f); z = `torque`, r
//! = its variance `noise`.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// Gravity torque and dry friction with their covariance.
#[derive(Debug, Clone)]
pub(super) struct LoadFrictionFilter<T: Real> {
    /// Gravity torque [N m].
    pub gravity_torque: T,
    /// Dry friction [N m].
    pub friction: T,
    /// Variances of gravity torque and friction and their covariance, in the unit of the measurement's variance.
    variance: [T; 3],
}
state_words! { struct LoadFrictionFilter<T> { gravity_torque, friction, variance } }

impl<T: Real> LoadFrictionFilter<T> {
    /// Starts from a known friction, and the variances of gravity torque and friction.
    pub fn new(friction: T, [gravity_variance, friction_variance]: [T; 2]) -> Self {
        Self { gravity_torque: T::ZERO, friction, variance: [gravity_variance, friction_variance, T::ZERO] }
    }

    /// Torque that brakes a link moving in a direction [N m].
    pub fn torque(&self, direction: T) -> T {
        self.gravity_torque + self.friction * direction
    }

    /// Variance of [`Self::torque`].
    pub fn variance(&self, direction: T) -> T {
        let [gravity_torque, friction, cross_covariance] = self.variance;
        gravity_torque + (T::TWO * cross_covariance + friction * direction) * direction
    }

    /// Adds the growth of the variances per period: gravity torque and friction may change.
    pub fn predict(&mut self, [gravity_growth, friction_growth]: [T; 2]) {
        self.variance[0] += gravity_growth;
        self.variance[1] += friction_growth;
    }

    /// Resets the variance of the gravity torque, whose value no longer holds.
    pub fn reset_gravity_variance(&mut self, variance: T) {
        self.variance = [variance, self.variance[1], T::ZERO];
    }

    /// Corrects the state by a measured torque of a link moving in a direction; friction stays within 0 and
    /// `friction_limit`. Returns the correction of the gravity torque.
    pub fn correct(&mut self, torque: T, direction: T, noise: T, friction_limit: T) -> T {
        let [gravity_torque, friction, cross_covariance] = self.variance;
        let (gravity_covariance, friction_covariance) =
            (gravity_torque + cross_covariance * direction, cross_covariance + friction * direction);
        let total = gravity_covariance + friction_covariance * direction + noise;
        if total <= T::ZERO || !total.is_finite() {
            return T::ZERO;
        }
        let (gravity_gain, friction_gain) = (gravity_covariance / total, friction_covariance / total);
        let innovation = torque - self.gravity_torque - self.friction * direction;
        self.gravity_torque += gravity_gain * innovation;
        self.friction = clamp(self.friction + friction_gain * innovation, T::ZERO, friction_limit);
        self.variance = [
            gravity_torque - gravity_gain * gravity_covariance,
            friction - friction_gain * friction_covariance,
            cross_covariance - gravity_gain * friction_covariance,
        ];
        gravity_gain * innovation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a filter after measurements of a gravity torque and a friction, one in each of the directions [N m].
    fn measured(gravity_torque: f64, friction: f64, directions: &[f64]) -> LoadFrictionFilter<f64> {
        let mut filter = LoadFrictionFilter::new(0.0, [100.0; 2]);
        for direction in directions {
            filter.correct(gravity_torque + friction * direction, *direction, 1e-6, 10.0);
        }
        filter
    }

    #[test]
    fn motion_both_ways_separates_load_and_friction() {
        let filter = measured(3.0, 1.0, &[1.0, -1.0]);
        assert!((filter.gravity_torque - 3.0).abs() < 1e-4 && (filter.friction - 1.0).abs() < 1e-4);
    }

    #[test]
    fn motion_one_way_gives_the_sum_only() {
        let filter = measured(3.0, 1.0, &[1.0; 10]);
        assert!((filter.torque(1.0) - 4.0).abs() < 1e-4);
        assert!((filter.gravity_torque - 2.0).abs() < 1e-4, "shared by the variances: {}", filter.gravity_torque);
    }

    #[test]
    fn friction_never_becomes_negative() {
        assert_eq!(measured(0.0, -2.0, &[1.0, -1.0, 1.0]).friction, 0.0);
    }

    #[test]
    fn friction_stays_within_its_limit() {
        assert_eq!(measured(0.0, 20.0, &[1.0, -1.0]).friction, 10.0);
    }

    #[test]
    fn certain_state_ignores_a_measurement_without_noise() {
        let mut filter = LoadFrictionFilter::new(1.0, [0.0; 2]);
        assert_eq!(filter.correct(5.0, 1.0, 0.0, 10.0), 0.0);
        assert_eq!((filter.gravity_torque, filter.friction), (0.0, 1.0));
    }

    #[test]
    fn noise_that_is_not_finite_changes_nothing() {
        for noise in [f64::NAN, f64::INFINITY] {
            let mut filter = LoadFrictionFilter::new(1.0, [1.0; 2]);
            assert_eq!(filter.correct(5.0, 1.0, noise, 10.0), 0.0);
            assert_eq!((filter.gravity_torque, filter.friction), (0.0, 1.0));
        }
    }

    #[test]
    fn measurement_lowers_the_variance_of_its_direction() {
        let filter = measured(3.0, 1.0, &[1.0]);
        assert!(filter.variance(1.0) < 1e-5 && filter.variance(-1.0) > 100.0);
    }

    #[test]
    fn predicted_variance_grows_by_both_states() {
        let mut filter = LoadFrictionFilter::new(0.0, [1.0, 2.0]);
        filter.predict([0.5, 0.25]);
        assert_eq!(filter.variance(1.0), 3.75);
    }
}

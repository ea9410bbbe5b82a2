//! Torque bias and dry friction of the motor, measured inside the gap, where the meshes carry no force: a recursive
//! least squares with two bounded parameters.
//!
//! ```text
//! (O16) gap open:  t/r_s = bias + friction dir + noise,   friction >= 0
//! ```
//!
//! Symbols: t/r_s = `force`, dir = `direction`, var(noise) = `bias_noise`.

use super::thresholds::OUTLIER;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;
use crate::observer::tables::ContactTable;

/// Apparent force of the motor side without mesh force: bias + friction * direction [N].
#[derive(Debug, Clone, Copy)]
pub struct TorqueBias<T: Real> {
    pub bias: T,
    pub friction: T,
    /// Variances of bias and friction, then their covariance [N^2].
    pub variance: [T; 3],
}
state_words! { struct TorqueBias<T> { bias, friction, variance } }

impl<T: Real> TorqueBias<T> {
    pub fn new(table: &ContactTable<T>) -> Self {
        Self { bias: T::ZERO, friction: T::ZERO, variance: [table.bias_prior, table.bias_prior, T::ZERO] }
    }

    /// Returns true if bias and friction are within their limits and no variance exceeds the initial one.
    pub fn is_in_range(&self, table: &ContactTable<T>) -> bool {
        let [bias, friction, both] = self.variance;
        let max_variance = table.bias_prior + table.bias_drift;
        self.bias.abs() <= table.bias_limit
            && self.friction >= T::ZERO
            && self.friction <= table.bias_limit
            && [bias, friction].iter().all(|variance| *variance >= T::ZERO && *variance <= max_variance)
            && both.abs() <= max_variance
    }

    /// Direction of dry friction at a motor speed, from -1 to 1: proportional where noise hides the sign.
    pub fn direction(table: &ContactTable<T>, speed: T) -> T {
        clamp(speed * table.per_turning, -T::ONE, T::ONE)
    }

    /// Apparent force without mesh force, for a direction [N].
    pub fn force_at(&self, direction: T) -> T {
        self.bias + self.friction * direction
    }

    /// Variance of this apparent force [N^2].
    pub fn variance_at(&self, direction: T) -> T {
        let [bias, friction, both] = self.variance;
        bias + direction * (T::TWO * both + direction * friction)
    }

    /// Updates the estimate with a force measured in the open gap.
    pub fn update(&mut self, table: &ContactTable<T>, force: T, direction: T) {
        let [bias, friction, both] = self.variance;
        let (from_bias, from_friction) = (bias + direction * both, both + direction * friction);
        let expected = table.bias_noise + from_bias + direction * from_friction;
        let innovation = force - self.force_at(direction);
        // An outlier was not measured in an open gap.
        if innovation * innovation > T::from_i32(OUTLIER.bias_sigma * OUTLIER.bias_sigma) * expected {
            return;
        }
        let (bias_gain, friction_gain) = (from_bias / expected, from_friction / expected);
        self.bias = clamp(self.bias + bias_gain * innovation, -table.bias_limit, table.bias_limit);
        // Friction is never negative: it does not drive.
        let friction_now = clamp(self.friction + friction_gain * innovation, -table.bias_limit, table.bias_limit);
        self.friction = if friction_now > T::ZERO { friction_now } else { T::ZERO };
        self.variance =
            [bias - bias_gain * from_bias, friction - friction_gain * from_friction, both - bias_gain * from_friction];
    }

    /// Saved numbers.
    pub fn saved_numbers(&self) -> impl Iterator<Item = T> {
        [self.bias, self.friction].into_iter().chain(self.variance)
    }

    /// Restores the saved numbers.
    pub fn restore_numbers(&mut self, next_number: &mut impl FnMut() -> T) {
        [&mut self.bias, &mut self.friction]
            .into_iter()
            .chain(&mut self.variance)
            .for_each(|number| *number = next_number());
    }

    /// Increases the variances by the drift of a learning interval.
    pub fn inflate_variance(&mut self, table: &ContactTable<T>) {
        let [bias, friction, _] = &mut self.variance;
        for variance in [bias, friction] {
            if *variance < table.bias_prior {
                *variance += table.bias_drift;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::contact;

    #[test]
    fn direction_is_proportional_at_low_speed() {
        let directions = [0.25, 0.5, 5.0, -5.0].map(|speed: f32| TorqueBias::direction(&contact(), speed));
        assert_eq!(directions, [0.5, 1.0, 1.0, -1.0]);
    }

    #[test]
    fn motion_both_ways_separates_bias_and_friction() {
        let mut bias = TorqueBias::new(&contact());
        for _ in 0..200 {
            bias.update(&contact(), 3.0, 1.0);
            bias.update(&contact(), -1.0, -1.0);
        }
        assert!((bias.bias - 1.0).abs() < 0.02 && (bias.friction - 2.0).abs() < 0.02, "{bias:?}");
        assert!((bias.force_at(-1.0) + 1.0).abs() < 0.04);
    }

    #[test]
    fn outlier_is_rejected() {
        // The innovation has the variance 1 + 4 + 4.
        let mut bias = TorqueBias::<f32>::new(&contact());
        bias.update(&contact(), 12.1, 1.0);
        assert_eq!(bias.bias, 0.0);
        bias.update(&contact(), 11.9, 1.0);
        assert!(bias.bias > 5.0);
    }

    #[test]
    fn bias_is_limited() {
        let mut bias = TorqueBias::<f32>::new(&contact());
        (0..1000).for_each(|_| {
            bias.variance = [100.0, 0.0, 0.0];
            bias.update(&contact(), 20.0, 0.0);
        });
        assert_eq!(bias.bias, contact().bias_limit);
    }

    #[test]
    fn friction_is_never_negative() {
        let mut bias = TorqueBias::<f32>::new(&contact());
        for _ in 0..100 {
            bias.update(&contact(), -2.0, 1.0);
            bias.update(&contact(), 2.0, -1.0);
        }
        assert_eq!(bias.friction, 0.0);
    }

    #[test]
    fn variance_grows_up_to_prior() {
        let mut bias = TorqueBias::<f32>::new(&contact());
        bias.variance = [3.8, 1.0, 0.0];
        bias.inflate_variance(&contact());
        bias.inflate_variance(&contact());
        assert_eq!(bias.variance, [4.3, 2.0, 0.0]);
        assert!(bias.is_in_range(&contact()));
        bias.variance[0] = 4.6;
        assert!(!bias.is_in_range(&contact()));
    }

    #[test]
    fn saved_nan_is_out_of_range() {
        let mut bias = TorqueBias::<f32>::new(&contact());
        bias.bias = f32::NAN;
        assert!(!bias.is_in_range(&contact()));
    }
}

//! Integral of a PID on the motor position, with back-calculation.
//!
//! ```text
//! (K18)  u_i' = J w^3 (r + s - theta_m) + w (torque - torque before the limit),   |u_i| <= M_max
//! ```
//!
//! Symbols: u_i = `torque`, theta_m - s - r = `position_error`, torque less torque before the limit = `cut`.

use super::torque_swing::TorqueSwing;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// Integral of a PID on the motor position, and detector of a swinging torque.
#[derive(Debug, Clone)]
pub(super) struct Integral<T: Real> {
    /// Torque of the integral [N m].
    torque: T,
    swing: TorqueSwing<T>,
}
state_words! { struct Integral<T> { torque, swing } }

impl<T: Real> Integral<T> {
    pub fn new() -> Self {
        Self { torque: T::ZERO, swing: TorqueSwing::new() }
    }

    /// Torque of the integral [N m].
    pub fn torque(&self) -> T {
        self.torque
    }

    /// Checks the torque of the PID before its limit for a swing, once in `periods` periods [N m].
    pub fn detect_swing(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        self.swing.update(tables, torque, periods);
    }

    /// True if the torque has swung from side to side.
    pub fn swings(&self) -> bool {
        self.swing.swings()
    }

    /// Adds a torque [N m], within the motor's limit; a sum that is not finite is ignored.
    pub fn add(&mut self, tables: &CompensationTables<T>, torque: T) {
        let next = self.torque + torque;
        if next.is_finite() {
            self.torque = clamp(next, -tables.limits.motor, tables.limits.motor);
        }
    }

    /// Updates the integral by the motor's position error `position_error` [rad] and the torque `cut` that the limit
    /// cut off [N m]. While the torque swings from side to side, a cut torque does not show that the integral is too
    /// large, so it is held. Integrating further under the limit would make a loop with a heavier link than designed
    /// swing from limit to limit without end.
    pub fn integrate(&mut self, tables: &CompensationTables<T>, position_error: T, cut: T) {
        if self.swings() && cut != T::ZERO {
            return;
        }
        self.add(tables, tables.law.back_calculation * cut - tables.law.integral * position_error);
    }

    /// Follows another torque with the time constant of the loop [N m].
    pub fn decay_toward(&mut self, tables: &CompensationTables<T>, torque: T) {
        self.add(tables, tables.law.back_calculation * (torque - self.torque));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::tables;

    #[test]
    fn integral_stays_within_the_motor_limit() {
        let mut integral = Integral::new();
        integral.add(&tables(), 25.0);
        assert_eq!(integral.torque(), 10.0);
        integral.add(&tables(), -25.0);
        assert_eq!(integral.torque(), -10.0);
    }

    #[test]
    fn sum_that_is_not_finite_is_ignored() {
        let mut integral = Integral::new();
        integral.add(&tables(), 1.0);
        [f64::NAN, f64::INFINITY].iter().for_each(|torque| integral.add(&tables(), *torque));
        assert_eq!(integral.torque(), 1.0);
    }

    #[test]
    fn integral_decays_toward_a_torque_with_the_loop() {
        let mut integral = Integral::new();
        (0..100).for_each(|_| integral.decay_toward(&tables(), 5.0));
        assert!((integral.torque() - 5.0 * (1.0 - f64::powi(0.99, 100))).abs() < 1e-9);
    }

    #[test]
    fn motor_beyond_its_set_point_lowers_the_integral() {
        let mut integral = Integral::new();
        integral.integrate(&tables(), 1e-3, 0.0);
        assert_eq!(integral.torque(), -4e-3);
    }
}

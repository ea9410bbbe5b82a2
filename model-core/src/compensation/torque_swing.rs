//! Detector of a torque that swings from side to side: then the delays of the loop exceed the designed ones, and the
//! motor bears less damping. A torque beyond half of the motor's limit on one side marks that side; the mark decays
//! within a quarter of the loop's time constant. A torque beyond half of the limit on the other side before then is a
//! swing.

use super::thresholds::TorqueSwingThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::deadband;
use crate::numbers::state_words::state_words;

/// Detector of a swing of the torque of one law.
#[derive(Debug, Clone)]
pub(super) struct TorqueSwing<T: Real> {
    /// Side on which the torque last was large, 1 or -1, decaying to 0.
    side: T,
    swings: bool,
}
state_words! { struct TorqueSwing<T> { side, swings } }

impl<T: Real> TorqueSwing<T> {
    const THRESHOLDS: TorqueSwingThresholds<T> = TorqueSwingThresholds::TUNED;

    pub fn new() -> Self {
        Self { side: T::ZERO, swings: false }
    }

    /// True if, since the start, the torque has changed from large on one side to large on the other within that time.
    pub fn swings(&self) -> bool {
        self.swings
    }

    /// Checks the torque of one of `periods` periods [N m].
    pub fn update(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        let excess = deadband(torque, Self::THRESHOLDS.large_torque * tables.limits.motor);
        if excess == T::ZERO {
            self.side = deadband(self.side, Self::THRESHOLDS.side_change_rate * periods * tables.law.back_calculation);
        } else {
            let new_side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.swings |= new_side * self.side < T::ZERO;
            self.side = new_side;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::tables;

    /// Returns true if a torque swings after it was `first`, zero for some periods, and `last` [N m].
    fn swings(first: f64, periods: u32, last: f64) -> bool {
        let mut swing = TorqueSwing::new();
        swing.update(&tables(), first, 1.0);
        (0..periods).for_each(|_| swing.update(&tables(), 0.0, 1.0));
        swing.update(&tables(), last, 1.0);
        swing.swings()
    }

    #[test]
    fn large_torque_on_both_sides_swings() {
        assert!(swings(6.0, 5, -6.0) && swings(-6.0, 5, 6.0));
    }

    #[test]
    fn large_torque_on_one_side_does_not_swing() {
        assert!(!swings(6.0, 5, 6.0));
    }

    #[test]
    fn torque_at_half_the_limit_is_not_large() {
        assert!(!swings(5.0, 0, -5.0) && !swings(5.1, 0, -5.0) && swings(5.1, 0, -5.1));
    }

    #[test]
    fn change_within_a_quarter_time_constant_swings() {
        // The time constant of the loop is a hundred periods.
        assert!(swings(6.0, 24, -6.0) && !swings(6.0, 26, -6.0));
    }

    #[test]
    fn torque_that_is_no_number_does_not_swing() {
        assert!(!swings(f64::NAN, 0, -6.0));
    }
}

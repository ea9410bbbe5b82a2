//! Detector of a torque that swings from side to side: then the delays of the loop exceed the designed ones, and the
//! motor bears less damping.

use super::thresholds::TorqueSwingThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::beyond;

/// Detector of a swing of the torque of one law.
#[derive(Debug, Clone)]
pub(super) struct TorqueSwing<T: Real> {
    /// Side on which the torque last was large, 1 or -1, decaying to 0.
    side: T,
    swings: bool,
}

impl<T: Real> TorqueSwing<T> {
    const THRESHOLDS: TorqueSwingThresholds<T> = TorqueSwingThresholds::VALUES;

    pub fn new() -> Self {
        Self { side: T::ZERO, swings: false }
    }

    /// True if, since the start, the torque has changed from large on one side to large on the other within that time.
    pub fn swings(&self) -> bool {
        self.swings
    }

    /// Checks the torque of one of `periods` periods [N m].
    pub fn update(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        let excess = beyond(torque, Self::THRESHOLDS.large_torque * tables.limits.motor);
        if excess == T::ZERO {
            self.side = beyond(self.side, Self::THRESHOLDS.side_change_rate * periods * tables.law.back_calculation);
        } else {
            let new_side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.swings |= new_side * self.side < T::ZERO;
            self.side = new_side;
        }
    }
}

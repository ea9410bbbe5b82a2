//! Detector of a torque that swings from side to side: then the delays of the loop exceed the designed ones, and the
//! motor bears less damping.

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
    /// Torque beyond which it counts as large, over the motor's limit [-].
    const LARGE_TORQUE_SHARE: T = T::HALF;

    /// Time constant of the loop over the time within which a swinging torque changes from side to side [-]: faster
    /// than any motion that the loop can follow.
    const SIDE_CHANGE_RATE: T = T::FOUR;

    pub fn new() -> Self {
        Self { side: T::ZERO, swings: false }
    }

    /// True if, since the start, the torque has changed from large on one side to large on the other within that time.
    pub fn swings(&self) -> bool {
        self.swings
    }

    /// Checks the torque of one of `periods` periods [N m].
    pub fn update(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        let excess = beyond(torque, Self::LARGE_TORQUE_SHARE * tables.limits.motor);
        if excess == T::ZERO {
            self.side = beyond(self.side, Self::SIDE_CHANGE_RATE * periods * tables.law.back_calculation);
        } else {
            let new_side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.swings |= new_side * self.side < T::ZERO;
            self.side = new_side;
        }
    }
}

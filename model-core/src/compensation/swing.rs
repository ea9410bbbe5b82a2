//! Detector of a torque that swings from side to side: then the delays of the loop exceed the designed ones, and the
//! motor bears less damping.

use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::deadband;

/// Detector of a swing of the torque of one law.
#[derive(Debug, Clone)]
pub(super) struct Swing<T: Real> {
    /// Side on which the torque last was large, 1 or -1, decaying to 0.
    large: T,
    swings: bool,
}

impl<T: Real> Swing<T> {
    /// Torque beyond which it counts as large, over the motor's limit [-].
    const LARGE: T = T::HALF;

    /// Time constant of the loop over the time within which a swinging torque changes from side to side [-]: faster
    /// than any motion that the loop can follow.
    const SWINGS: T = T::FOUR;

    pub fn new() -> Self {
        Self { large: T::ZERO, swings: false }
    }

    /// True if, since the start, the torque has changed from large on one side to large on the other within that time.
    pub fn swings(&self) -> bool {
        self.swings
    }

    /// Checks the torque of one of `periods` periods [N m].
    pub fn watch(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        let excess = deadband(torque, Self::LARGE * tables.limits.motor);
        if excess == T::ZERO {
            self.large = deadband(self.large, Self::SWINGS * periods * tables.law.back_calculation);
        } else {
            let side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.swings |= side * self.large < T::ZERO;
            self.large = side;
        }
    }
}

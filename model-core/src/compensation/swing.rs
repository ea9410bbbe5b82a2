//! Whether a torque swings from side to side: the loop has more delay than it was designed for, and its motor bears less damping.

use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::beyond;

/// Notices a swing of the torque of one law.
#[derive(Debug, Clone)]
pub(super) struct Swing<T: Real> {
    /// 1 or -1: to which side the torque last was large, fading to 0.
    large: T,
    swings: bool,
}

impl<T: Real> Swing<T> {
    /// A torque is large beyond this part of the motor's limit [-].
    const LARGE: T = T::HALF;

    /// Time constants of the loop over that within which the torque goes from side to side where it swings [-]. No motion
    /// that the loop can follow does.
    const SWINGS: T = T::FOUR;

    pub fn new() -> Self {
        Self { large: T::ZERO, swings: false }
    }

    /// Whether the torque has gone from large to large of the other side within that time since the start.
    pub fn swings(&self) -> bool {
        self.swings
    }

    /// Takes the torque of one of so many periods [N m].
    pub fn watch(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        let excess = beyond(torque, Self::LARGE * tables.limits.motor);
        if excess == T::ZERO {
            self.large = beyond(self.large, Self::SWINGS * periods * tables.law.back_calculation);
        } else {
            let side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.swings |= side * self.large < T::ZERO;
            self.large = side;
        }
    }
}

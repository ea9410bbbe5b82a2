//! More delay in the loop than it was designed for: a current loop slower than its data sheet says, or coarse encoders, whose
//! speeds come late. The damper on the motor then swings.

use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::beyond;

/// Whether plain control's torque has swung, which follows the motor's speed at once.
#[derive(Debug, Clone)]
pub(super) struct Delay<T: Real> {
    /// 1 or -1: to which side the torque last was large, fading to 0.
    large: T,
    /// Whether it has gone from large to large of the other side within that.
    longer: bool,
}

impl<T: Real> Delay<T> {
    /// A torque is large beyond this part of the motor's limit [-].
    const LARGE: T = T::HALF;

    /// Time constants of the loop over that within which the torque goes from side to side where it swings [-]. No motion
    /// that the loop can follow does.
    const SWINGS: T = T::FOUR;

    /// Part of its damping that the motor keeps [-]: what twice the reaction time allows.
    const KEPT: T = T::HALF;

    pub fn new() -> Self {
        Self { large: T::ZERO, longer: false }
    }

    /// Whether the loop has more delay than it was designed for; true for good.
    pub fn is_longer(&self) -> bool {
        self.longer
    }

    /// What the loop's delays allow the damper on the motor [N m s/rad].
    pub fn motor_damping(&self, tables: &CompensationTables<T>) -> T {
        if self.longer { Self::KEPT * tables.law.motor_damping } else { tables.law.motor_damping }
    }

    /// Takes plain control's torque in a period [N m].
    pub fn watch(&mut self, tables: &CompensationTables<T>, torque: T) {
        let excess = beyond(torque, Self::LARGE * tables.limits.motor);
        if excess == T::ZERO {
            self.large = beyond(self.large, Self::SWINGS * tables.law.back_calculation);
        } else {
            let side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.longer |= side * self.large < T::ZERO;
            self.large = side;
        }
    }
}

//! The integral of a PID on the motor's place, with back-calculation.

use super::swing::Swing;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// The integral of a PID on the motor's place, and whether its torque swings.
#[derive(Debug, Clone)]
pub(super) struct Integral<T: Real> {
    /// [N m].
    torque: T,
    swing: Swing<T>,
}

impl<T: Real> Integral<T> {
    pub fn new() -> Self {
        Self { torque: T::ZERO, swing: Swing::new() }
    }

    /// [N m].
    pub fn torque(&self) -> T {
        self.torque
    }

    /// Takes the torque that the PID gives before its limit, in one of so many periods [N m].
    pub fn watch(&mut self, tables: &CompensationTables<T>, torque: T, periods: T) {
        self.swing.watch(tables, torque, periods);
    }

    /// Whether that has swung from side to side.
    pub fn swings(&self) -> bool {
        self.swing.swings()
    }

    /// Adds a torque of a period, within the motor's limit; what is no number is left out [N m].
    pub fn add(&mut self, tables: &CompensationTables<T>, torque: T) {
        let next = self.torque + torque;
        if next.is_finite() {
            self.torque = clamp(next, -tables.limits.motor, tables.limits.motor);
        }
    }

    /// Integrates over a period in which the motor stands beyond its place by an angle [rad] and the limit took `cut` off
    /// [N m]. What the limit cuts off a torque that swings from side to side does not say that the integral is too large; but with an
    /// integral that goes on under the limit, a loop of a heavier link than designed would swing from limit to limit for good.
    pub fn integrate(&mut self, tables: &CompensationTables<T>, beyond: T, cut: T) {
        if self.swings() && cut != T::ZERO {
            return;
        }
        self.add(tables, tables.law.back_calculation * cut - tables.law.integral * beyond);
    }

    /// Lets it follow another torque with the time constant of the loop [N m].
    pub fn approach(&mut self, tables: &CompensationTables<T>, torque: T) {
        self.add(tables, tables.law.back_calculation * (torque - self.torque));
    }
}

//! What brakes the link, split into a part that does not care for the direction of motion (weight, a push) and dry
//! friction, which changes its sign with it: a Kalman filter with two states. The split is what makes the torque after
//! a reversal predictable.

use super::arithmetic::clamp;
use super::intent::Situation;
use crate::real::Real;
use crate::realtime::observer::Estimates;
use crate::tables::compensation::CompensationTables;

/// Even part and dry friction of the load torque.
#[derive(Debug, Clone)]
pub(super) struct LoadModel<T: Real> {
    even: T,
    friction: T,
    /// Variances of both and their covariance.
    variance: [T; 3],
}

impl<T: Real> LoadModel<T> {
    pub fn new() -> Self {
        Self { even: T::ZERO, friction: T::ZERO, variance: [T::ONE, T::ONE, T::ZERO] }
    }

    /// -1 to 1: what share of the dry friction brakes at a speed.
    pub fn direction(tables: &CompensationTables<T>, speed: T) -> T {
        clamp(tables.friction_slope * speed, -T::ONE, T::ONE)
    }

    pub fn even(&self) -> T {
        self.even
    }

    pub fn friction(&self) -> T {
        self.friction
    }

    /// Friction at a speed.
    pub fn drag(&self, tables: &CompensationTables<T>, speed: T) -> T {
        self.friction * Self::direction(tables, speed)
    }

    /// Takes the estimate of the load torque while a flank carries.
    pub fn observe(&mut self, tables: &CompensationTables<T>, estimates: &Estimates<T>, situation: &Situation<T>) {
        let torque = estimates.load_torque;
        if torque.valid && torque.value.is_finite() && situation.sees && situation.contact != T::ZERO {
            self.learn(tables, torque.value, situation.link_speed);
        }
    }

    fn learn(&mut self, tables: &CompensationTables<T>, torque: T, speed: T) {
        let direction = Self::direction(tables, speed);
        let [growth_even, growth_friction, noise] = tables.load_learner;
        let [even, friction, both] = self.variance;
        let (even, friction) = (even + growth_even, friction + growth_friction);
        let (to_even, to_friction) = (even + both * direction, both + friction * direction);
        let total = to_even + to_friction * direction + noise;
        if !(total > T::ZERO) {
            return;
        }
        let (gain_even, gain_friction) = (to_even.over(total), to_friction.over(total));
        let surprise = torque - self.even - self.friction * direction;
        self.even += gain_even * surprise;
        self.friction += gain_friction * surprise;
        self.variance = [even - gain_even * to_even, friction - gain_friction * to_friction, both - gain_even * to_friction];
    }
}

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
    /// Rate of the even part [N m/s].
    rate: T,
    /// What brakes a link that no flank carries, smoothed [N m].
    alone: Option<T>,
    /// Variances of both and their covariance.
    variance: [T; 3],
}

impl<T: Real> LoadModel<T> {
    pub fn new() -> Self {
        Self { even: T::ZERO, friction: T::ZERO, rate: T::ZERO, alone: None, variance: [T::ONE, T::ONE, T::ZERO] }
    }

    /// -1 to 1: what share of the dry friction brakes at a speed.
    pub fn direction(tables: &CompensationTables<T>, speed: T) -> T {
        clamp(tables.friction_slope * speed, -T::ONE, T::ONE)
    }

    /// Whether the link is so slow that it may rub with any part of its friction.
    fn creeps(tables: &CompensationTables<T>, speed: T) -> bool {
        let direction = Self::direction(tables, speed);
        direction < T::ONE && direction > -T::ONE
    }

    pub fn even(&self) -> T {
        self.even
    }

    /// Rate of the even part: weight turns with the link [N m/s].
    pub fn rate(&self) -> T {
        self.rate
    }

    pub fn friction(&self) -> T {
        self.friction
    }

    /// What would brake the link now if no flank carried it.
    pub fn free(&self, tables: &CompensationTables<T>, speed: T) -> T {
        self.alone.unwrap_or(self.even + self.drag(tables, speed))
    }

    /// Friction at a speed.
    pub fn drag(&self, tables: &CompensationTables<T>, speed: T) -> T {
        self.friction * Self::direction(tables, speed)
    }

    /// Takes the estimate of the load torque while a flank carries.
    pub fn observe(&mut self, tables: &CompensationTables<T>, estimates: &Estimates<T>, situation: &Situation<T>) {
        // A weight turns with the link.
        if Self::creeps(tables, situation.link_speed) {
            self.rate = T::ZERO;
        }
        self.even = clamp(self.even + tables.period * self.rate, -tables.torque_limit, tables.torque_limit);
        let torque = estimates.load_torque;
        let known = torque.valid && torque.value.is_finite() && situation.sees;
        // More than the motor can hold is no load that it carries.
        let held = clamp(torque.value, -tables.torque_limit, tables.torque_limit);
        let carried = known && situation.contact != T::ZERO;
        if carried {
            self.learn(tables, held, situation.link_speed);
        } else {
            self.rate *= tables.load_rate_left;
        }
        self.alone = if known && !carried {
            let before = self.free(tables, situation.link_speed);
            Some(before + tables.settling * (held - before))
        } else {
            None
        };
    }

    /// Integrates an error instead, where a flank should carry and no estimate says with what force.
    pub fn lean(&mut self, tables: &CompensationTables<T>, error: T) {
        let next = self.even + tables.integral_gain * error;
        if next.is_finite() {
            self.even = clamp(next, -tables.torque_limit, tables.torque_limit);
        }
    }

    fn learn(&mut self, tables: &CompensationTables<T>, torque: T, speed: T) {
        // What rubs with any part of its friction says nothing about the whole of it.
        let direction = if Self::creeps(tables, speed) { T::ZERO } else { Self::direction(tables, speed) };
        let known = self.drag(tables, speed);
        let [growth_even, growth_friction, noise] = tables.load_learner;
        let [even, friction, both] = self.variance;
        let (even, friction) = (even + growth_even, friction + growth_friction);
        let (to_even, to_friction) = (even + both * direction, both + friction * direction);
        let total = to_even + to_friction * direction + noise;
        if total <= T::ZERO || !total.is_finite() {
            return;
        }
        let (gain_even, gain_friction) = (to_even.over(total), to_friction.over(total));
        let surprise = torque - self.even - known;
        self.even += gain_even * surprise;
        self.rate =
            clamp(self.rate + tables.load_rate_gain * gain_even * surprise, -tables.fastest_load, tables.fastest_load);
        self.friction = clamp(self.friction + gain_friction * surprise, T::ZERO, tables.torque_limit);
        self.variance =
            [even - gain_even * to_even, friction - gain_friction * to_friction, both - gain_even * to_friction];
    }
}

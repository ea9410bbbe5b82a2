//! The stream of impedance set-points: how often they come, and how they go on between two of them.

use super::set_point::ImpedancePoint;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// What is remembered of the stream.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stream<T: Real> {
    last: Option<ImpedancePoint<T>>,
    /// For how long the last set-point has been held [s].
    age: T,
    /// For how long set-points are held as a rule [s].
    interval: T,
    /// Rate of the torque that is sent along [N m/s].
    torque_rate: T,
    /// How far the point went from the set-point before to the last one [turns].
    travel: T,
}

impl<T: Real> Stream<T> {
    /// Takes the set-point of this period.
    pub fn step(&mut self, tables: &CompensationTables<T>, point: &ImpedancePoint<T>) {
        match self.last {
            Some(last) if last == *point => {
                self.age = clamp(self.age + tables.clock.period, T::ZERO, tables.law.longest_hold);
                if self.rests(tables) {
                    self.torque_rate = T::ZERO;
                }
            }
            Some(last) => {
                // One that was held longest says nothing of the interval; one that was held for longer than usual tells a new one.
                if self.age < tables.law.longest_hold {
                    self.interval = self.age + tables.clock.period;
                }
                let between = if self.interval > tables.clock.period { self.interval } else { tables.clock.period };
                let rate = (point.torque - last.torque).over(between);
                // Half of the change: what jitters from one set-point to the next is no trend.
                self.torque_rate = T::HALF * (self.torque_rate + rate);
                self.travel = point.position.less(last.position.turns, last.position.fraction);
                self.age = T::ZERO;
            }
            None => {}
        }
        self.last = Some(*point);
    }

    /// Rate of the torque that is sent along [N m/s].
    pub fn torque_rate(&self) -> T {
        self.torque_rate
    }

    /// Speed of the point or, of one that jumps without, which way it went.
    pub fn direction(&self) -> T {
        match self.last {
            Some(last) if last.speed != T::ZERO => last.speed,
            _ => self.travel,
        }
    }

    /// By how much longer than on the average the set-point has been held: it goes on meanwhile, unless it rests
    /// [s].
    pub fn overdue(&self, tables: &CompensationTables<T>) -> T {
        if self.rests(tables) { T::ZERO } else { self.age - T::HALF * self.interval }
    }

    /// Held for so long that it stands still, or the stream has ended.
    pub fn rests(&self, tables: &CompensationTables<T>) -> bool {
        let missed = self.interval > T::ZERO && self.age > T::TWO * self.interval;
        missed || self.age >= tables.law.longest_hold
    }
}

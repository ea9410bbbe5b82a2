//! Whoever streams impedance set-points: at what pace, and how what is sent goes on between two of them. What a set-point
//! asks for is left to `impedance`.

use super::set_point::ImpedancePoint;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// What is remembered of the sender.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sender<T: Real> {
    last: Option<ImpedancePoint<T>>,
    /// For how long the last set-point has been held [s].
    age: T,
    /// For how long set-points are held as a rule [s].
    pace: T,
    /// Rate of the torque that is sent along [N m/s].
    torque_rate: T,
    /// How far the point went from the set-point before to the last one [turns].
    way: T,
}

impl<T: Real> Sender<T> {
    /// Takes the set-point of this period.
    pub fn hear(&mut self, tables: &CompensationTables<T>, point: &ImpedancePoint<T>) {
        match self.last {
            Some(last) if last == *point => {
                self.age = clamp(self.age + tables.period, T::ZERO, tables.longest_hold);
                if self.rests(tables) {
                    self.torque_rate = T::ZERO;
                }
            }
            Some(last) => {
                // One that was held longest says nothing of the pace; one that was held for longer than usual tells a new one.
                if self.age < tables.longest_hold {
                    self.pace = self.age + tables.period;
                }
                let between = if self.pace > tables.period { self.pace } else { tables.period };
                let rate = (point.torque - last.torque).over(between);
                // Half of the news: what jitters from one set-point to the next is no course.
                self.torque_rate = T::HALF * (self.torque_rate + rate);
                self.way = point.position.less(last.position.turns, last.position.fraction);
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
    pub fn course(&self) -> T {
        match self.last {
            Some(last) if last.speed != T::ZERO => last.speed,
            _ => self.way,
        }
    }

    /// By how much longer than on the average the set-point has been held: its course goes on meanwhile, unless it rests
    /// [s].
    pub fn overdue(&self, tables: &CompensationTables<T>) -> T {
        if self.rests(tables) { T::ZERO } else { self.age - T::HALF * self.pace }
    }

    /// Held for so long that it stands still, or its sender has fallen silent.
    pub fn rests(&self, tables: &CompensationTables<T>) -> bool {
        let missed = self.pace > T::ZERO && self.age > T::TWO * self.pace;
        missed || self.age >= tables.longest_hold
    }
}

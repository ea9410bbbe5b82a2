//! The motor side: a disturbance observer that says what torque the motor loses to the meshes. Taking friction and bias
//! out of that is left to `bias`.
//!
//! State: angle beyond the counts, speed, taken torque, air-gap torque. Over a period the state follows the linear flow
//! of the tables (current loop included), then a part of the surprise in the angle is added to each.

use super::late::Since;
use crate::numbers::Real;
use crate::observer::tables::{CurrentTable, DriveTable, MOST_DELAY};

/// State of the motor side.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct DriveSide<T: Real> {
    /// Angle beyond the counts [rad].
    pub ahead: T,
    /// [rad/s].
    pub speed: T,
    /// Torque taken from the motor by meshes and friction [N m].
    pub taken: T,
    air_gap: T,
    /// Commands on their way to the motor, the newest first.
    on_the_way: [T; MOST_DELAY],
}

impl<T: Real> DriveSide<T> {
    /// Over one period, under the command in force during it; `turned` is by how much the counts moved [rad].
    pub fn predict(&mut self, table: &DriveTable<T>, current: &CurrentTable<T>, command: T, turned: T) {
        self.on_the_way.rotate_right(1);
        self.on_the_way[0] = command;
        let at = |ago: u32| self.on_the_way.get(ago as usize).copied().unwrap_or(command);
        let sooner = at(current.whole_delay);
        let wanted = sooner + current.part_delay * (at(current.whole_delay + 1) - sooner);
        let [from_speed, from_taken, from_air_gap, from_wanted] = table.angle;
        self.ahead +=
            from_speed * self.speed + from_taken * self.taken + from_air_gap * self.air_gap + from_wanted * wanted
                - turned;
        let [from_taken, from_air_gap, from_wanted] = table.speed;
        self.speed += from_taken * self.taken + from_air_gap * self.air_gap + from_wanted * wanted;
        self.air_gap += current.rise * (wanted - self.air_gap);
    }

    /// Takes in a reading of this period, `age` old [s].
    pub fn correct(&mut self, table: &DriveTable<T>, age: T) {
        self.take(&table.gain, self.speed * age - self.ahead);
    }

    /// Takes in an older one, where what has changed since matters.
    #[cold]
    pub fn correct_late(&mut self, table: &DriveTable<T>, age: T) {
        let [period, ..] = table.angle;
        let [by_torque, ..] = table.speed;
        let quickening = by_torque * (self.taken - self.air_gap);
        let since = Since { periods: age.over(period), period, quickening, by_torque };
        self.take(&since.carried(&table.late_gain), since.went(self.speed) - self.ahead);
    }

    /// Takes in by how much the measured angle exceeds the expected one [rad].
    fn take(&mut self, gain: &[T; 3], surprise: T) {
        let [angle, speed, taken] = *gain;
        self.ahead += angle * surprise;
        self.speed += speed * surprise;
        self.taken += taken * surprise;
    }

    /// Nothing has been heard of the motor: it stands where its counts were, as far as anyone knows.
    pub fn hold(&mut self) {
        self.ahead = T::ZERO;
        self.speed = T::ZERO;
        self.taken = T::ZERO;
    }
}

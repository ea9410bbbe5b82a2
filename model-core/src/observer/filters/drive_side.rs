//! Disturbance observer of the motor side (O2; late readings O3): estimates the torque that meshes and friction take
//! from the motor. `learnt::bias` separates the two. Symbols: a = `ahead`, w_m = `speed`, t = `taken`, u = `air_gap`,
//! G = `gain`.
//!
//! Each period the state follows the linear flow of the tables, current loop included. `gain` times the innovation, the
//! measured less the predicted angle, then corrects angle, speed and taken torque; the air-gap torque is not corrected.

use super::delayed::Delayed;
use crate::numbers::Real;
use crate::observer::tables::{CurrentTable, DriveTable, MOST_DELAY};

/// State of the motor side.
#[derive(Debug, Clone, Copy, Default)]
pub struct DriveSide<T: Real> {
    /// Angle beyond the counts [rad].
    pub ahead: T,
    /// Motor speed [rad/s].
    pub speed: T,
    /// Torque taken from the motor by meshes and friction [N m].
    pub taken: T,
    air_gap: T,
    /// Decaying maximum of the air-gap torque's magnitude [N m].
    strongest: T,
    /// Commands within the delay, newest first.
    commands: [T; MOST_DELAY],
}

impl<T: Real> DriveSide<T> {
    /// Decay of `strongest` per period [-]: a speed computed from counts lags by a few periods.
    const FADES: T = T::TWENTIETH;

    /// Predicts the state over one period under the command in force; `turned` is the travel of the counts [rad].
    pub fn predict(&mut self, table: &DriveTable<T>, current: &CurrentTable<T>, command: T, turned: T) {
        self.commands.rotate_right(1);
        self.commands[0] = command;
        let at = |ago: u32| self.commands.get(ago as usize).copied().unwrap_or(command);
        let newer = at(current.whole_delay);
        let wanted = newer + current.part_delay * (at(current.whole_delay + 1) - newer);
        let [from_speed, from_taken, from_air_gap, from_wanted] = table.angle;
        self.ahead +=
            from_speed * self.speed + from_taken * self.taken + from_air_gap * self.air_gap + from_wanted * wanted
                - turned;
        let [from_taken, from_air_gap, from_wanted] = table.speed;
        self.speed += from_taken * self.taken + from_air_gap * self.air_gap + from_wanted * wanted;
        self.air_gap += current.rise * (wanted - self.air_gap);
        let torque = self.air_gap.abs();
        self.strongest = if torque > self.strongest { torque } else { self.strongest - Self::FADES * self.strongest };
    }

    /// Corrects by a reading of this period, with its age [s].
    pub fn correct(&mut self, table: &DriveTable<T>, age: T) {
        self.apply(&table.gain, self.speed * age - self.ahead);
    }

    /// Corrects by an older reading, including the change of speed since then.
    #[cold]
    pub fn correct_late(&mut self, table: &DriveTable<T>, age: T) {
        let [period, ..] = table.angle;
        let [speed_per_torque, ..] = table.speed;
        let speed_change = speed_per_torque * (self.taken - self.air_gap);
        let delayed = Delayed { periods: age.over(period), period, speed_change, speed_per_torque };
        self.apply(&delayed.gain_now(&table.late_gain), delayed.travel(self.speed) - self.ahead);
    }

    /// Adds gain times innovation [rad].
    fn apply(&mut self, gain: &[T; 3], innovation: T) {
        let [angle, speed, taken] = *gain;
        self.ahead += angle * innovation;
        self.speed += speed * innovation;
        self.taken += taken * innovation;
    }

    /// Returns the air-gap torque [N m].
    pub fn air_gap(&self) -> T {
        self.air_gap
    }

    /// Returns the decaying maximum of the air-gap torque's magnitude [N m].
    pub fn strongest(&self) -> T {
        self.strongest
    }

    /// Sets the motor at rest at its last counts, without a usable reading.
    pub fn hold(&mut self) {
        self.ahead = T::ZERO;
        self.speed = T::ZERO;
        self.taken = T::ZERO;
    }
}

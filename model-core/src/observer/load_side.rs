//! The load side: a disturbance observer on the link that says where it is, how fast and what brakes it. What the
//! meshes pass on is given to it.
//!
//! The state's angle is relative to a reference that the caller moves: the output counts, or, motor only, the motor's
//! counts over the ratio.

use super::late::Since;
use crate::numbers::Real;
use crate::observer::tables::LoadTable;

/// State of the load side.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LoadSide<T: Real> {
    /// Angle beyond the reference [rad].
    pub ahead: T,
    /// [rad/s].
    pub speed: T,
    /// What brakes the link [N m].
    pub torque: T,
}

impl<T: Real> LoadSide<T> {
    /// Over one period, under a torque from the meshes; `turned` is by how much the reference moved [rad].
    pub fn predict(&mut self, table: &LoadTable<T>, from_meshes: T, turned: T) {
        let net = from_meshes - self.torque;
        let [from_speed, from_net] = table.angle;
        self.ahead += from_speed * self.speed + from_net * net - turned;
        self.speed += table.speed * net;
    }

    /// Takes in that the reading is where the reference is, and was `age` old [s], under a torque from the meshes.
    pub fn correct(&mut self, table: &LoadTable<T>, age: T, from_meshes: T) {
        let [period, _] = table.angle;
        if age < period {
            return self.take(&table.gain, self.speed * age - self.ahead);
        }
        self.correct_late(table, age, from_meshes);
    }

    /// The same where what has changed since the reading matters.
    #[cold]
    fn correct_late(&mut self, table: &LoadTable<T>, age: T, from_meshes: T) {
        let [period, _] = table.angle;
        let quickening = table.speed * (from_meshes - self.torque);
        let since = Since { periods: age.over(period), period, quickening, by_torque: -table.speed };
        self.take(&since.carried(&table.gain), since.went(self.speed) - self.ahead);
    }

    /// Takes in by how much the measured angle exceeds the expected one [rad].
    pub fn take(&mut self, gain: &[T; 3], surprise: T) {
        let [angle, speed, torque] = *gain;
        self.ahead += angle * surprise;
        self.speed += speed * surprise;
        self.torque += torque * surprise;
    }
}

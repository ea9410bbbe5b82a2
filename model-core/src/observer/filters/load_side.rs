//! The load side: a disturbance observer on the link that says where it is, how fast it turns and what torque brakes it.
//! The torque that the meshes pass on is its input.
//!
//! The state's angle is relative to a reference: the output counts or, with the motor encoder only, the motor's counts
//! over the ratio.

use super::delayed::Delayed;
use crate::numbers::Real;
use crate::observer::tables::LoadTable;

/// State of the load side.
#[derive(Debug, Clone, Copy, Default)]
pub struct LoadSide<T: Real> {
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

    /// Corrects by a reading that is where the reference is, `age` old [s], under a torque from the meshes.
    pub fn correct(&mut self, table: &LoadTable<T>, age: T, from_meshes: T) {
        let [period, _] = table.angle;
        if age < period {
            return self.apply(&table.gain, self.speed * age - self.ahead);
        }
        self.correct_late(table, age, from_meshes);
    }

    /// The same where the change of speed since the reading matters.
    #[cold]
    fn correct_late(&mut self, table: &LoadTable<T>, age: T, from_meshes: T) {
        let [period, _] = table.angle;
        let speed_change = table.speed * (from_meshes - self.torque);
        let delayed = Delayed { periods: age.over(period), period, speed_change, speed_per_torque: -table.speed };
        self.apply(&delayed.gain_now(&table.gain), delayed.travel(self.speed) - self.ahead);
    }

    /// Adds gain times innovation [rad].
    pub fn apply(&mut self, gain: &[T; 3], innovation: T) {
        let [angle, speed, torque] = *gain;
        self.ahead += angle * innovation;
        self.speed += speed * innovation;
        self.torque += torque * innovation;
    }
}

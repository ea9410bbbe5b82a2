//! Disturbance observer of the load side (O4): estimates angle, speed and load torque of the link. Input is the mesh
//! torque. Symbols: a = `angle_residual`, w_l = `speed`, t_l = `torque`.
//!
//! The angle is relative to a reference: the output counts or, without an output encoder, the motor counts over the
//! ratio.

use super::delayed::Delayed;
use crate::numbers::Real;
use crate::observer::tables::LoadTable;

/// State of the load side.
#[derive(Debug, Clone, Copy, Default)]
pub struct LoadSide<T: Real> {
    /// Angle beyond the reference [rad].
    pub angle_residual: T,
    /// Link speed [rad/s].
    pub speed: T,
    /// Load torque, positive if it brakes [N m].
    pub torque: T,
}

impl<T: Real> LoadSide<T> {
    /// Predicts the state over one period under a mesh torque; `turned` is the travel of the reference [rad].
    pub fn predict(&mut self, table: &LoadTable<T>, from_meshes: T, turned: T) {
        let net = from_meshes - self.torque;
        let [from_speed, from_net] = table.angle;
        self.angle_residual += from_speed * self.speed + from_net * net - turned;
        self.speed += table.speed * net;
    }

    /// Corrects by a reading at the reference, with its age [s], under a mesh torque.
    pub fn correct(&mut self, table: &LoadTable<T>, age: T, from_meshes: T) {
        let [period, _] = table.angle;
        if age < period {
            return self.apply(&table.gain, self.speed * age - self.angle_residual);
        }
        self.correct_late(table, age, from_meshes);
    }

    /// Corrects by a reading older than a period, including the change of speed since then.
    #[cold]
    fn correct_late(&mut self, table: &LoadTable<T>, age: T, from_meshes: T) {
        let [period, _] = table.angle;
        let speed_change = table.speed * (from_meshes - self.torque);
        let delayed = Delayed { periods: age / period, period, speed_change, speed_per_torque: -table.speed };
        self.apply(&delayed.gain_now(&table.gain), delayed.travel(self.speed) - self.angle_residual);
    }

    /// Adds gain times innovation [rad].
    pub fn apply(&mut self, gain: &[T; 3], innovation: T) {
        let [angle, speed, torque] = *gain;
        self.angle_residual += angle * innovation;
        self.speed += speed * innovation;
        self.torque += torque * innovation;
    }
}

//! The load side: a disturbance observer on the link that says where it is, how fast and what brakes it. What the
//! meshes pass on is given to it.
//!
//! The state's angle is relative to a reference that the caller moves: the output counts, or, motor only, the motor's
//! counts over the ratio.

use crate::real::Real;
use crate::tables::observer::LoadTable;

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

    /// Takes in by how much the measured angle exceeds the expected one [rad].
    pub fn correct(&mut self, gain: &[T; 3], surprise: T) {
        let [angle, speed, torque] = *gain;
        self.ahead += angle * surprise;
        self.speed += speed * surprise;
        self.torque += torque * surprise;
    }
}

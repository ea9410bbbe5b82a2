//! Disturbance observer of the load side: a steady-state Kalman filter for angle, speed and load torque of the link.
//!
//! ```text
//! (O4)  a' = w_l,  J_l w_l' = m r_o F - t_l,  t_l' = noise
//!       reading:  z = age w_l - a,  (a, w_l, t_l) += G z          older than a period: as (O3)
//! ```
//!
//! Symbols: a = `angle_residual`, w_l = `speed`, t_l = `torque`, m r_o F = `mesh_torque`, z = `innovation`, G = `gain`.
//!
//! The angle is relative to a reference: the output counts or, without an output encoder, the motor counts over the
//! ratio.

use super::delayed::Delayed;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
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
state_words! { struct LoadSide<T> { angle_residual, speed, torque } }

impl<T: Real> LoadSide<T> {
    /// Predicts the state over one period under a mesh torque; `reference_angle` is the travel of the reference [rad].
    pub fn predict(&mut self, table: &LoadTable<T>, mesh_torque: T, reference_angle: T) {
        let net = mesh_torque - self.torque;
        let [from_speed, from_net] = table.angle;
        self.angle_residual += from_speed * self.speed + from_net * net - reference_angle;
        self.speed += table.speed * net;
    }

    /// Corrects by a reading at the reference, with its age [s], under a mesh torque.
    pub fn correct(&mut self, table: &LoadTable<T>, age: T, mesh_torque: T) {
        let [period, _] = table.angle;
        if age < period {
            return self.apply(&table.gain, self.speed * age - self.angle_residual);
        }
        self.correct_late(table, age, mesh_torque);
    }

    /// Corrects by a reading older than a period, including the change of speed since then.
    #[cold]
    fn correct_late(&mut self, table: &LoadTable<T>, age: T, mesh_torque: T) {
        let [period, _] = table.angle;
        let speed_change = table.speed * (mesh_torque - self.torque);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::load;

    #[test]
    fn net_torque_accelerates_link() {
        let mut side = LoadSide { torque: 1.0, ..LoadSide::default() };
        side.predict(&load(), 3.0, 0.0);
        assert_eq!((side.angle_residual, side.speed), (1.0, 2.0));
        side.predict(&load(), 1.0, 3.0);
        assert_eq!((side.angle_residual, side.speed), (0.0, 2.0));
    }

    #[test]
    fn reading_behind_raises_load_torque() {
        let mut side = LoadSide { angle_residual: 1.0, ..LoadSide::default() };
        side.correct(&load(), 0.0, 0.0);
        assert_eq!((side.angle_residual, side.speed, side.torque), (0.5, -0.25, 0.125));
    }

    #[test]
    fn late_reading_uses_speed_at_its_time() {
        // Speed 2 now under 2 N m: 0 one period ago, so that the link has turned by 1 rad since.
        let mut side = LoadSide { angle_residual: 1.0, speed: 2.0, torque: 0.0 };
        side.correct(&load(), 1.0, 2.0);
        assert_eq!((side.angle_residual, side.speed, side.torque), (1.0, 2.0, 0.0));
    }
}

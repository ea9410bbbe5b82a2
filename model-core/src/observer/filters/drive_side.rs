//! Disturbance observer of the motor side: a steady-state Kalman filter that estimates the torque of meshes and
//! friction. `identification::bias` separates the two.
//!
//! ```text
//! (O2)  a' = w_m,  J_m w_m' = u - t,  t' = noise          u follows the delayed command with the current lag
//!       fresh reading:  z = age w_m - a,  (a, w_m, t) += G z
//! (O3)  late reading:   z = n T (w_m - n T w_m'/2) - a,  (a, w_m, t) += exp(A n T) G_late z
//! ```
//!
//! | symbol | code | |
//! |---|---|---|
//! | a | `angle_residual` | angle beyond the counts [rad] |
//! | w_m | `speed` | motor speed [rad/s] |
//! | t | `disturbance_torque` | torque of meshes and friction [N m] |
//! | u | `air_gap` | air-gap torque, not corrected [N m] |
//! | z, G, G_late | `innovation`, `gain`, `late_gain` | |
//! | n, T | `Delayed::periods`, `Delayed::period` | age of the reading [periods], control period [s] |

use super::delayed::Delayed;
use super::thresholds::MotorSideThresholds;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::{CurrentTable, DriveTable, MOST_DELAY};

/// State of the motor side.
#[derive(Debug, Clone, Copy, Default)]
pub struct DriveSide<T: Real> {
    /// Motor angle minus the angle of its counts [rad].
    pub angle_residual: T,
    /// Motor speed [rad/s].
    pub speed: T,
    /// Torque taken from the motor by meshes and friction [N m].
    pub disturbance_torque: T,
    air_gap: T,
    /// Decaying maximum of the air-gap torque's magnitude [N m].
    peak_torque: T,
    /// Commands within the delay, newest first.
    commands: [T; MOST_DELAY],
}
state_words! { struct DriveSide<T> { angle_residual, speed, disturbance_torque, air_gap, peak_torque, commands } }

impl<T: Real> DriveSide<T> {
    const LIMITS: MotorSideThresholds<T> = MotorSideThresholds::TUNED;

    /// Predicts the state over one period under the command in force; `counted_angle` is the travel of the counts [rad].
    pub fn predict(&mut self, table: &DriveTable<T>, current: &CurrentTable<T>, command: T, counted_angle: T) {
        self.commands.rotate_right(1);
        self.commands[0] = command;
        let at = |ago: u32| self.commands.get(ago as usize).copied().unwrap_or(command);
        let newer = at(current.whole_delay);
        let delayed_command = newer + current.part_delay * (at(current.whole_delay + 1) - newer);
        let [from_speed, from_disturbance, from_air_gap, from_command] = table.angle;
        self.angle_residual += from_speed * self.speed
            + from_disturbance * self.disturbance_torque
            + from_air_gap * self.air_gap
            + from_command * delayed_command
            - counted_angle;
        let [from_disturbance, from_air_gap, from_command] = table.speed;
        self.speed +=
            from_disturbance * self.disturbance_torque + from_air_gap * self.air_gap + from_command * delayed_command;
        self.air_gap += current.rise * (delayed_command - self.air_gap);
        let torque = self.air_gap.abs();
        self.peak_torque = if torque > self.peak_torque {
            torque
        } else {
            self.peak_torque - Self::LIMITS.peak_decay * self.peak_torque
        };
    }

    /// Corrects by a reading of this period, with its age [s].
    pub fn correct(&mut self, table: &DriveTable<T>, age: T) {
        self.apply(&table.gain, self.speed * age - self.angle_residual);
    }

    /// Corrects by an older reading, including the change of speed since then.
    #[cold]
    pub fn correct_late(&mut self, table: &DriveTable<T>, age: T) {
        let [period, ..] = table.angle;
        let [speed_per_torque, ..] = table.speed;
        let speed_change = speed_per_torque * (self.disturbance_torque - self.air_gap);
        let delayed = Delayed { periods: age / period, period, speed_change, speed_per_torque };
        self.apply(&delayed.gain_now(&table.late_gain), delayed.travel(self.speed) - self.angle_residual);
    }

    /// Adds gain times innovation [rad].
    fn apply(&mut self, gain: &[T; 3], innovation: T) {
        let [angle, speed, disturbance_torque] = *gain;
        self.angle_residual += angle * innovation;
        self.speed += speed * innovation;
        self.disturbance_torque += disturbance_torque * innovation;
    }

    /// Returns the air-gap torque [N m].
    pub fn air_gap(&self) -> T {
        self.air_gap
    }

    /// Returns the decaying maximum of the air-gap torque's magnitude [N m].
    pub fn peak_torque(&self) -> T {
        self.peak_torque
    }

    /// Sets the motor at rest at its last counts, without a usable reading.
    pub fn stop(&mut self) {
        self.angle_residual = T::ZERO;
        self.speed = T::ZERO;
        self.disturbance_torque = T::ZERO;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::{current, drive};

    #[test]
    fn torque_accelerates_motor() {
        let mut side = DriveSide::default();
        side.predict(&drive(), &current(), 2.0, 0.0);
        assert_eq!((side.angle_residual, side.speed, side.air_gap()), (1.0, 2.0, 2.0));
        side.predict(&drive(), &current(), 0.0, 3.0);
        assert_eq!((side.angle_residual, side.speed), (0.0, 2.0), "2 rad further, less 3 rad of counts");
    }

    #[test]
    fn disturbance_torque_brakes_motor() {
        let mut side = DriveSide { disturbance_torque: 1.0, ..DriveSide::default() };
        side.predict(&drive(), &current(), 0.0, 0.0);
        assert_eq!(side.speed, -1.0);
    }

    #[test]
    fn command_acts_after_delay() {
        let delayed = CurrentTable { whole_delay: 1, part_delay: 0.5, ..current() };
        let mut side = DriveSide::default();
        let air_gap = [4.0, 0.0, 0.0, 0.0].map(|command| {
            side.predict(&drive(), &delayed, command, 0.0);
            side.air_gap()
        });
        assert_eq!(air_gap, [0.0, 2.0, 2.0, 0.0]);
    }

    #[test]
    fn peak_torque_decays() {
        let mut side = DriveSide::default();
        side.predict(&drive(), &current(), -4.0, 0.0);
        assert_eq!(side.peak_torque(), 4.0);
        side.predict(&drive(), &current(), 1.0, 0.0);
        assert!((side.peak_torque() - 3.8).abs() < 1e-6);
    }

    #[test]
    fn reading_ahead_raises_angle_and_speed() {
        let mut side = DriveSide { angle_residual: -1.0, ..DriveSide::default() };
        side.correct(&drive(), 0.0);
        assert_eq!((side.angle_residual, side.speed, side.disturbance_torque), (-0.5, 0.25, -0.125));
    }

    #[test]
    fn age_moves_expected_angle() {
        let mut side = DriveSide { angle_residual: 0.5, speed: 1.0, ..DriveSide::default() };
        side.correct(&drive(), 0.5);
        assert_eq!((side.angle_residual, side.speed), (0.5, 1.0), "the motor turned 0.5 rad since the reading");
    }
}

//! Usual practice: motor PID plus half the guessed lost motion in the direction of the wanted speed, regardless of
//! whether friction or inertia dominates.

use super::Knowledge;
use super::motor_pid::{MotorPid, geared};
use crate::closed_loop::{Controller, SetPoint};
use crate::drive_train::Measurement;

/// Motor PID with an offset by the sign of the speed.
#[derive(Debug, Clone)]
pub struct VelocitySign {
    pid: MotorPid,
    offset: f64,
}

impl VelocitySign {
    /// Controller of a bandwidth [rad/s].
    pub fn new(knowledge: Knowledge, bandwidth: f64) -> Self {
        Self { pid: MotorPid::new(knowledge, bandwidth), offset: 0.0 }
    }
}

impl Controller for VelocitySign {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        let motion = set_point.motion();
        let half = 0.5 * self.pid.knowledge().lost_motion;
        if motion.speed != 0.0 {
            self.offset = half * motion.speed.signum();
        }
        let mut motor = geared(motion, self.pid.knowledge().ratio);
        motor.position += self.pid.knowledge().ratio * self.offset;
        self.pid.follow(measurement.motor_counts, motor, 0.0)
    }
}

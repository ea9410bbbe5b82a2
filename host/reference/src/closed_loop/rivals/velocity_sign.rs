//! The usual practice: the motor PID with half the guessed lost motion added in the direction of the wanted speed,
//! whether friction or inertia drives the joint.

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
    /// Of a bandwidth [rad/s].
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

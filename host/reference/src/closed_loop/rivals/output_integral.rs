//! Strongest usual method: motor PID with feedforward of the true friction and most of the weight, a reference that
//! jumps by the guessed lost motion when the planned torque changes sign, and an integral of the output encoder's
//! error. Contact and load are not estimated.

use super::Knowledge;
use super::motor_pid::{MotorPid, geared};
use crate::closed_loop::{Controller, LinkTracker, SetPoint};
use crate::drive_train::Measurement;

/// Share of the weight in the feedforward.
const GRAVITY_SHARE: f64 = 0.85;

/// Speed at which the friction feedforward saturates [rad/s].
const FRICTION_SPEED: f64 = 0.01;

/// Rate of the output integral relative to the bandwidth.
const INTEGRAL_RATE: f64 = 0.25;

/// Motor PID with feedforward, jump and output integral.
#[derive(Debug, Clone)]
pub struct OutputIntegral {
    pid: MotorPid,
    link: LinkTracker,
    rate: f64,
    side: f64,
    trim: f64,
}

impl OutputIntegral {
    /// Controller of a bandwidth [rad/s].
    pub fn new(knowledge: Knowledge, bandwidth: f64) -> Self {
        let link = LinkTracker::new(
            knowledge.counts_per_turn[1],
            super::motor_pid::TRACKER_POLE * bandwidth,
            knowledge.period,
        );
        Self { pid: MotorPid::new(knowledge, bandwidth), link, rate: INTEGRAL_RATE * bandwidth, side: 0.0, trim: 0.0 }
    }
}

impl Controller for OutputIntegral {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        let motion = set_point.motion();
        let (link, _) = self.link.step(measurement.output_counts);
        let Knowledge { ratio, lost_motion, load_friction, motor_friction, gravity, period, .. } =
            *self.pid.knowledge();
        let knowledge = self.pid.knowledge();
        let load_inertia = (knowledge.total_inertia - knowledge.motor_inertia) * ratio * ratio;
        let direction = (motion.speed / FRICTION_SPEED).clamp(-1.0, 1.0);
        let load = load_friction * direction + GRAVITY_SHARE * gravity * motion.position.sin();
        let planned = load_inertia * motion.acceleration + load;
        if planned != 0.0 {
            self.side = planned.signum();
        }
        self.trim += period * self.rate * (motion.position - link);
        // Limit: the largest error of the guessed width, with room for encoder errors.
        self.trim = self.trim.clamp(-lost_motion, lost_motion);
        let mut motor = geared(motion, ratio);
        motor.position += ratio * (0.5 * self.side * lost_motion + self.trim);
        self.pid.follow(measurement.motor_counts, motor, load / ratio + motor_friction * direction)
    }
}

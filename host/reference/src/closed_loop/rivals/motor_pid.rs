//! Baseline: PID on the motor encoder alone, triple pole at the bandwidth for the total rigid inertia, with
//! acceleration feedforward and back-calculation anti-windup. The gap is ignored.

use super::Knowledge;
use crate::closed_loop::{Controller, Motion, MotorTracker, SetPoint};
use crate::drive_train::Measurement;

/// Poles of the speed filter relative to the bandwidth: fast enough for the loop's phase, slow enough for 14 bits.
pub(super) const TRACKER_POLE: f64 = 30.0;

/// PID on the motor.
#[derive(Debug, Clone)]
pub struct MotorPid {
    knowledge: Knowledge,
    bandwidth: f64,
    tracker: MotorTracker,
    integral: f64,
    torque: f64,
}

impl MotorPid {
    /// PID of a bandwidth [rad/s].
    pub fn new(knowledge: Knowledge, bandwidth: f64) -> Self {
        let tracker = tracker(&knowledge, bandwidth);
        Self { knowledge, bandwidth, tracker, integral: 0.0, torque: 0.0 }
    }

    /// Follows a motion of the motor shaft, with a feedforward torque in addition to the acceleration's.
    pub(super) fn follow(&mut self, counts: i64, motion: Motion, feed_forward: f64) -> f64 {
        let (angle, speed) = self.tracker.step(counts, self.torque);
        let (inertia, pole) = (self.knowledge.total_inertia, self.bandwidth);
        let error = motion.position - angle;
        let wanted = inertia * motion.acceleration
            + feed_forward
            + 3.0 * inertia * pole * pole * error
            + 3.0 * inertia * pole * (motion.speed - speed)
            + self.integral;
        let limit = self.knowledge.torque_limit;
        self.torque = wanted.clamp(-limit, limit);
        let growth = inertia * pole.powi(3) * error + pole * (self.torque - wanted);
        self.integral += self.knowledge.period * growth;
        self.torque
    }

    pub(super) fn knowledge(&self) -> &Knowledge {
        &self.knowledge
    }
}

/// Motor speed filter of all rivals.
pub(super) fn tracker(knowledge: &Knowledge, bandwidth: f64) -> MotorTracker {
    MotorTracker::new(knowledge.counts_per_turn[0], knowledge.motor_inertia, TRACKER_POLE * bandwidth, knowledge.period)
}

/// Motion of the motor shaft for a motion of the link.
pub(super) fn geared(motion: Motion, ratio: f64) -> Motion {
    Motion { position: ratio * motion.position, speed: ratio * motion.speed, acceleration: ratio * motion.acceleration }
}

impl Controller for MotorPid {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        let motion = geared(set_point.motion(), self.knowledge.ratio);
        self.follow(measurement.motor_counts, motion, 0.0)
    }
}

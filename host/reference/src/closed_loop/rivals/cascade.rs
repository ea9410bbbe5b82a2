//! Plain load cascade: a proportional loop on the output encoder sets the speed of a proportional-integral loop on the
//! motor. The gap is ignored.

use super::Knowledge;
use super::motor_pid::tracker;
use crate::closed_loop::{Controller, LinkTracker, MotorTracker, SetPoint};
use crate::drive_train::Measurement;

/// Cascade of link position and motor speed.
#[derive(Debug, Clone)]
pub struct LoadCascade {
    knowledge: Knowledge,
    bandwidth: f64,
    motor: MotorTracker,
    link: LinkTracker,
    integral: f64,
    torque: f64,
}

impl LoadCascade {
    /// Cascade of a bandwidth [rad/s].
    pub fn new(knowledge: Knowledge, bandwidth: f64) -> Self {
        let motor = tracker(&knowledge, bandwidth);
        let link = LinkTracker::new(
            knowledge.counts_per_turn[1],
            super::motor_pid::TRACKER_POLE * bandwidth,
            knowledge.period,
        );
        Self { knowledge, bandwidth, motor, link, integral: 0.0, torque: 0.0 }
    }
}

impl Controller for LoadCascade {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        let motion = set_point.motion();
        let (_, speed) = self.motor.step(measurement.motor_counts, self.torque);
        let (link, _) = self.link.step(measurement.output_counts);
        let Knowledge { ratio, total_inertia: inertia, torque_limit: limit, period, .. } = self.knowledge;
        // s^3 + 3 w s^2 + 3 w^2 s + (3/4) w^3: the nearest to a triple pole that real gains of a cascade allow.
        let pole = self.bandwidth;
        let speed_error = ratio * (motion.speed + 0.5 * pole * (motion.position - link)) - speed;
        let damping = 3.0 * inertia * pole;
        let wanted = inertia * ratio * motion.acceleration + damping * speed_error + self.integral;
        self.torque = wanted.clamp(-limit, limit);
        self.integral += period * (0.5 * pole * damping * speed_error + pole * (self.torque - wanted));
        self.torque
    }
}

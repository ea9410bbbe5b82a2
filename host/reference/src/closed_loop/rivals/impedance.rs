//! Impedance laws without compensation: spring and damper about a moving point, each measured at the motor or at the
//! link. The torque ignores the gap.

use super::Knowledge;
use super::motor_pid::TRACKER_POLE;
use crate::closed_loop::{Controller, LinkTracker, MotorTracker, SetPoint};
use crate::drive_train::Measurement;

/// Place of measurement of spring and damper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImpedanceLaw {
    /// Spring and damper at the motor.
    MotorSide,
    /// Spring at the link, damper at the motor.
    LinkSpring,
    /// Spring and damper at the link.
    LinkSide,
}

/// Impedance law.
#[derive(Debug, Clone)]
pub struct Impedance {
    knowledge: Knowledge,
    law: ImpedanceLaw,
    motor: MotorTracker,
    link: LinkTracker,
    torque: f64,
}

impl Impedance {
    /// Impedance law; `bandwidth` sets the speed filters only [rad/s].
    pub fn new(knowledge: Knowledge, law: ImpedanceLaw, bandwidth: f64) -> Self {
        let motor = super::motor_pid::tracker(&knowledge, bandwidth);
        let link = LinkTracker::new(knowledge.counts_per_turn[1], TRACKER_POLE * bandwidth, knowledge.period);
        Self { knowledge, law, motor, link, torque: 0.0 }
    }
}

impl Controller for Impedance {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        let (motor, motor_speed) = self.motor.step(measurement.motor_counts, self.torque);
        let (link, link_speed) = self.link.step(measurement.output_counts);
        let Knowledge { ratio, torque_limit: limit, .. } = self.knowledge;
        let SetPoint::Impedance { about, torque, stiffness, damping } = *set_point else {
            self.torque = 0.0;
            return 0.0;
        };
        let (position, speed) = match self.law {
            ImpedanceLaw::MotorSide => (motor / ratio, motor_speed / ratio),
            ImpedanceLaw::LinkSpring => (link, motor_speed / ratio),
            ImpedanceLaw::LinkSide => (link, link_speed),
        };
        let wanted = torque + stiffness * (about.position - position) + damping * (about.speed - speed);
        self.torque = (wanted / ratio).clamp(-limit, limit);
        self.torque
    }
}

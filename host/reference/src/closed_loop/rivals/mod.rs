//! Rival controllers for comparison with the compensation, as strong as their kind allows: designed for the true
//! inertias, with equal bandwidth, encoders and torque limit. No rival knows the gap; its width is guessed.

mod cascade;
mod impedance;
mod motor_pid;
mod output_integral;
mod velocity_sign;

pub use cascade::LoadCascade;
pub use impedance::{Impedance, ImpedanceLaw};
pub use motor_pid::MotorPid;
pub use output_integral::OutputIntegral;
pub use velocity_sign::VelocitySign;

use parameters::JointParameters;

use crate::drive_train::DriveTrainParameters;

/// Design data of a rival.
#[derive(Debug, Clone)]
pub struct Knowledge {
    /// Motor turns per link turn.
    pub ratio: f64,
    /// Inertia that turns with the motor while the gap is open, referred to the motor [kg m^2].
    pub motor_inertia: f64,
    /// Total inertia, referred to the motor [kg m^2].
    pub total_inertia: f64,
    /// [N m].
    pub torque_limit: f64,
    /// [s].
    pub period: f64,
    /// Counts per turn of motor and output encoder.
    pub counts_per_turn: [u64; 2],
    /// Guessed total lost motion at the link [rad].
    pub lost_motion: f64,
    /// Dry friction at the link [N m].
    pub load_friction: f64,
    /// Dry friction at the motor [N m].
    pub motor_friction: f64,
    /// Amplitude of the gravity torque, times sin(link angle) [N m].
    pub gravity: f64,
}

impl Knowledge {
    /// Design data of a joint, true except for the lost motion, which is wrong by a factor.
    pub fn of(joint: &JointParameters, train: &DriveTrainParameters, width_factor: f64) -> Self {
        let around = &train.surroundings;
        let geometry = &joint.geometry;
        let cosine = libm::cos(geometry.working_pressure_angle);
        let lever = geometry.carrier_radius * cosine;
        let ratio = 1.0 + f64::from(geometry.ring_teeth) / f64::from(geometry.sun_teeth);
        let sun = geometry.sun_base_radius.powi(2);
        let motor_inertia = joint.rotor_inertia + joint.bodies.sun_equivalent_mass * sun;
        let planets = geometry.planets as f64 * joint.bodies.planet_equivalent_mass;
        let carried =
            joint.bodies.carrier_inertia_over_radius_squared + geometry.planets as f64 * joint.bodies.planet_mass;
        let carrier = (planets + carried / (cosine * cosine)) * lever * lever + joint.link_inertia;
        let half = joint.sun_planet.half_backlash.iter().sum::<f64>() / geometry.planets as f64;
        Self {
            ratio,
            motor_inertia,
            total_inertia: motor_inertia + carrier / (ratio * ratio),
            torque_limit: around.torque_limit,
            period: 1.0 / f64::from(around.control_rate),
            counts_per_turn: [around.motor_encoder, around.output_encoder].map(|encoder| encoder.counts_per_turn),
            lost_motion: width_factor * 2.0 * half / lever,
            load_friction: around.load_friction.coulomb,
            motor_friction: around.motor_friction.coulomb,
            gravity: around.gravity_torque,
        }
    }
}

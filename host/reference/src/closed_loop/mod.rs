//! Closed loop on the drive train: controllers behind one trait, rivals of the compensation, motions, records of runs,
//! and figures of merit.

mod metrics;
mod profile;
pub mod rivals;
mod run;
mod sensing;

pub use metrics::{Figures, deviation};
pub use profile::{MotionProfile, Profile, SharedProfile, minimum_jerk, swelling};
pub use rivals::{Impedance, ImpedanceLaw, LoadCascade, MotorPid, OutputIntegral, VelocitySign};
pub use run::{Run, Sample};
pub use sensing::{LinkTracker, MotorTracker};

use crate::drive_train::Measurement;

/// Wanted motion of the link at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion {
    /// Position [rad].
    pub position: f64,
    /// Speed [rad/s].
    pub speed: f64,
    /// Acceleration [rad/s^2].
    pub acceleration: f64,
}

/// Set-point of a controller in one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SetPoint {
    /// Follow a position.
    Position {
        /// Present motion.
        now: Motion,
        /// Motion one preview time later, for controllers with preview.
        ahead: Option<Motion>,
    },
    /// Act as a spring and damper about a moving point.
    Impedance {
        /// Moving point; its acceleration is not sent.
        about: Motion,
        /// Feedforward torque [N m].
        torque: f64,
        /// Stiffness [N m/rad].
        stiffness: f64,
        /// Damping [N m s/rad].
        damping: f64,
    },
}

impl SetPoint {
    /// Returns the present wanted motion.
    pub fn motion(&self) -> Motion {
        match *self {
            Self::Position { now, .. } => now,
            Self::Impedance { about, .. } => about,
        }
    }
}

/// Controller of the joint, called once per control period.
pub trait Controller {
    /// Returns the motor torque for the period that begins [N m].
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64;
}

impl<C: Controller + ?Sized> Controller for &mut C {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        (**self).period(measurement, set_point)
    }
}

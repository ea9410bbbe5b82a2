//! What a closed loop on the drive train is made of and judged by: controllers behind one trait, the rivals that
//! compensation is measured against, motions, what happened, and figures of merit.

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

/// Where the link shall be at one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion {
    /// [rad].
    pub position: f64,
    /// [rad/s].
    pub speed: f64,
    /// [rad/s^2].
    pub acceleration: f64,
}

/// What a controller is asked for in one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SetPoint {
    /// Follow a position.
    Position {
        /// Now.
        now: Motion,
        /// The same one preview time later, for controllers that were promised one.
        ahead: Option<Motion>,
    },
    /// Behave as a spring and damper about a moving point.
    Impedance {
        /// Moving point; its acceleration is not sent.
        about: Motion,
        /// Torque on top [N m].
        torque: f64,
        /// [N m/rad].
        stiffness: f64,
        /// [N m s/rad].
        damping: f64,
    },
}

impl SetPoint {
    /// The motion asked for now.
    pub fn motion(&self) -> Motion {
        match *self {
            Self::Position { now, .. } => now,
            Self::Impedance { about, .. } => about,
        }
    }
}

/// A controller of the joint, once a control period.
pub trait Controller {
    /// Motor torque for the period that begins now [N m].
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64;
}

impl<C: Controller + ?Sized> Controller for &mut C {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        (**self).period(measurement, set_point)
    }
}

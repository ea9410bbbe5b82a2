//! Closed loops on the drive train: controllers behind one trait, the rivals that compensation is measured against,
//! profiles, random plants and figures of merit. Bounds are `tolerance`'s business, files of tests the host command's.

mod bench;
mod metrics;
mod plants;
mod profile;
pub mod rivals;
mod sensing;

pub use bench::{Bench, BenchError, ImpedanceGains, Run, Sample};
pub use metrics::{Figures, deviation};
pub use plants::{Variation, random_plant};
pub use profile::{Profile, Reference};
pub use rivals::{Impedance, ImpedanceLaw, LoadCascade, MotorPid, OutputIntegral, VelocitySign};
pub use sensing::{LinkTracker, MotorTracker};

use crate::drive_train::{Measurement, TrueTorques};
use crate::joint::Observation;

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

    /// Shows the truth, for controllers that stand in for a perfect observer. No rival looks at it.
    fn witness(&mut self, joint: &Observation, torques: &TrueTorques) {
        let _ = (joint, torques);
    }
}

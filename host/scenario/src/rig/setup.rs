//! Setup of a loop as plain data: the true joint with its drive train, the reference motion, disturbances and faults.

use parameters::JointParameters;
use reference::closed_loop::SharedProfile;
use reference::drive_train::{Disturbance, DriveTrainParameters, Stepping};
use reference::joint::{RelativeState, Start};

use crate::file::Fault;
use crate::plant::PlantName;

/// Everything about a run except the controller.
#[derive(Clone)]
pub struct Setup {
    /// Model of the joint.
    pub plant: PlantName,
    /// True joint.
    pub joint: JointParameters,
    /// True drive train.
    pub train: DriveTrainParameters,
    /// Initial state of the teeth.
    pub start: Start,
    /// State of the teeth in which the encoders were mounted, so that both agree; `None` for the initial state.
    pub mounting: Option<Start>,
    /// Stepping of the f64 reference.
    pub stepping: Stepping,
    /// Torques on the link.
    pub disturbances: Vec<Disturbance>,
    /// Faults with their times.
    pub faults: Vec<Fault>,
    /// Desired motion of the link.
    pub motion: SharedProfile,
    /// Seed of all noise.
    pub seed: u64,
    /// Length [s].
    pub duration: f64,
}

impl Setup {
    /// Joint on the f64 reference in the middle of its gap, with the fixed step, without disturbances and faults.
    pub fn new(
        joint: JointParameters,
        train: DriveTrainParameters,
        motion: SharedProfile,
        duration: f64,
        seed: u64,
    ) -> Self {
        Self {
            plant: PlantName::Reference,
            start: Start::Relative(RelativeState::centred(joint.geometry.planets)),
            mounting: None,
            joint,
            train,
            stepping: Stepping::Fixed,
            disturbances: Vec::new(),
            faults: Vec::new(),
            motion,
            seed,
            duration,
        }
    }
}

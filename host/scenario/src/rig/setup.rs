//! Everything that a loop is closed around, as plain data: the true joint with its drive train, the reference motion,
//! disturbances and faults.

use parameters::JointParameters;
use reference::closed_loop::SharedProfile;
use reference::drive_train::{Disturbance, DriveTrainParameters, Stepping};
use reference::joint::{RelativeState, Start};

use crate::file::Fault;
use crate::plant::PlantName;

/// Everything about a run but the controller.
#[derive(Clone)]
pub struct Setup {
    /// Which model of the joint moves.
    pub plant: PlantName,
    /// The true joint.
    pub joint: JointParameters,
    /// What truly surrounds it.
    pub train: DriveTrainParameters,
    /// How the teeth lie at first; the core's own step begins in the middle of its gap, whatever stands here.
    pub start: Start,
    /// How the f64 reference is stepped.
    pub stepping: Stepping,
    /// Torques on the link.
    pub disturbances: Vec<Disturbance>,
    /// What goes wrong, and when.
    pub faults: Vec<Fault>,
    /// Where the link shall be.
    pub motion: SharedProfile,
    /// Of all noise.
    pub seed: u64,
    /// Length [s].
    pub duration: f64,
}

impl Setup {
    /// A joint on the f64 reference that starts in the middle of its gap and is stepped fast, without pushes and faults.
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

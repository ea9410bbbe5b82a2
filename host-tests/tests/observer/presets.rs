//! Presets with their drive trains, for the plant. Phases of encoder errors are drawn by the seed.

use std::f64::consts::TAU;

use parameters::JointParameters;
use reference::drive_train::{DriveTrainParameters, ErrorPhases};
use reference::scenarios::same;

use crate::motion::uniform;

/// Preset joint with ripple and transmission error, and its drive train.
pub fn preset(name: &str, seed: u64) -> (JointParameters, DriveTrainParameters) {
    let file = joint_file::read(joint_file::preset(name).expect("a preset")).expect("a good preset");
    let mut uniform = uniform(seed ^ 0x5eed);
    let mut phases = || ErrorPhases { once_per_turn: TAU * uniform(), twice_per_turn: TAU * uniform() };
    let parameters = DriveTrainParameters {
        motor_error_phases: phases(),
        output_error_phases: phases(),
        ..file.surroundings.into()
    };
    (file.parameters, parameters)
}

/// Joint with another half-backlash [m].
pub fn with_backlash(joint: &JointParameters, half_backlash: f64) -> JointParameters {
    let mut joint = joint.clone();
    let planets = joint.geometry.planets;
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash = same(planets, half_backlash);
    }
    joint
}

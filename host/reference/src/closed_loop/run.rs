//! Record of a closed-loop run, with the true motion period by period.

use crate::joint::Observation;

/// True state at the end of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sample {
    /// [s].
    pub time: f64,
    /// Wanted link angle [rad].
    pub wanted: f64,
    /// Link angle [rad].
    pub link: f64,
    /// [rad/s].
    pub link_speed: f64,
    /// Gap coordinate relative to 2b: -1 to 1 while every mesh is free.
    pub gap: f64,
    /// Sum of the forces of all sun-planet meshes [N].
    pub mesh_force: f64,
    /// Torque between carrier and link [N m].
    pub transmitted: f64,
    /// Commanded motor torque [N m].
    pub command: f64,
}

impl Sample {
    /// Sample of a joint with a half-backlash [m] under a command [N m].
    pub fn of(joint: &Observation, wanted: f64, half_backlash: f64, command: f64) -> Self {
        Self {
            time: joint.time,
            wanted,
            link: joint.link_angle,
            link_speed: joint.link_speed,
            gap: if half_backlash > 0.0 { joint.gap / (2.0 * half_backlash) } else { joint.gap.signum() },
            mesh_force: joint.sun_force(),
            transmitted: joint.wind_up_torque,
            command,
        }
    }
}

/// Record of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Samples, one per control period.
    pub samples: Vec<Sample>,
    /// Control period [s].
    pub period: f64,
}

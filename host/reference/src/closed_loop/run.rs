//! Record of a closed-loop run, with the true motion period by period.

use crate::joint::Observation;

/// The truth at the end of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sample {
    /// [s].
    pub time: f64,
    /// Where the link was to be [rad].
    pub wanted: f64,
    /// Where it is [rad].
    pub link: f64,
    /// [rad/s].
    pub link_speed: f64,
    /// Gap coordinate over 2b: -1 to 1 while every mesh is free.
    pub gap: f64,
    /// All sun-planet meshes together [N].
    pub mesh_force: f64,
    /// Between carrier and link [N m].
    pub transmitted: f64,
    /// Asked of the motor [N m].
    pub command: f64,
}

impl Sample {
    /// Of a joint whose half-backlash is now so much [m], under a command [N m].
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

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// One for each control period.
    pub samples: Vec<Sample>,
    /// Control period [s].
    pub period: f64,
}

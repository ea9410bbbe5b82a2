//! Outputs of the reference at one instant, in SI, without encoders, noise and delays.

use heapless::Vec;
use parameters::{ContactState, MAX_PLANETS, PerPlanet};

/// The joint at one moment. Lists of two hold sun-planet meshes first, ring-planet meshes second.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Time [s].
    pub time: f64,
    /// Sun and motor rotor [rad].
    pub motor_angle: f64,
    /// [rad/s].
    pub motor_speed: f64,
    /// Carrier [rad].
    pub carrier_angle: f64,
    /// [rad/s].
    pub carrier_speed: f64,
    /// Link; equal to the carrier when no compliance is between them [rad].
    pub link_angle: f64,
    /// [rad/s].
    pub link_speed: f64,
    /// Rigid-body carrier angle, which no internal force can move [turns].
    pub rigid_turns: f64,
    /// Its speed [rad/s].
    pub rigid_speed: f64,
    /// Sun angle less its rigid share, small and without loss of digits at many turns [rad].
    pub motor_offset: f64,
    /// Link angle less the rigid-body carrier angle, likewise [rad].
    pub link_offset: f64,
    /// Gap coordinate u_s - 2 u_c along the line of action [m].
    pub gap: f64,
    /// [m/s].
    pub gap_rate: f64,
    /// Carrier less link along the line of action, u_c - u_l; zero without compliance [m].
    pub wind_up: f64,
    /// [m/s].
    pub wind_up_rate: f64,
    /// Mesh deflections d = displacement - e [m].
    pub deflections: [PerPlanet; 2],
    /// [m/s].
    pub deflection_rates: [PerPlanet; 2],
    /// Mesh forces along the line of action [N].
    pub mesh_forces: [PerPlanet; 2],
    /// Which flanks touch.
    pub contacts: [Vec<ContactState, MAX_PLANETS>; 2],
    /// Torque that passes from carrier to link; zero without compliance [N m].
    pub wind_up_torque: f64,
    /// Kinetic energy of all bodies [J].
    pub kinetic_energy: f64,
    /// Energy in meshes and compliance [J].
    pub elastic_energy: f64,
    /// Where energy came from and went to since the start.
    pub work: Work,
}

/// Work done since the start. Kinetic plus elastic energy grows by
/// `supplied - dissipated - against_errors + by_stiffness`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    /// By drive torque, less what the load took [J].
    pub supplied: f64,
    /// Lost in mesh damping and in the compliance [J].
    pub dissipated: f64,
    /// Done by the meshes against the imposed transmission errors [J].
    pub against_errors: f64,
    /// Brought in by changing mesh stiffness [J].
    pub by_stiffness: f64,
}

impl Work {
    /// What kinetic plus elastic energy must have grown by [J].
    pub fn net(&self) -> f64 {
        self.supplied - self.dissipated - self.against_errors + self.by_stiffness
    }
}

impl Observation {
    /// Elastic and damping force of all sun-planet meshes together [N].
    pub fn sun_force(&self) -> f64 {
        self.mesh_forces[0].iter().sum()
    }
}

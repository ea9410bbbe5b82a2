//! Outputs of the reference at one time, in SI, without encoders, noise and delays.

use heapless::Vec;
use parameters::{ContactState, MAX_PLANETS, PerPlanet};

/// State of the joint at one time. Lists of two hold sun-planet meshes first, ring-planet meshes second.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Time [s].
    pub time: f64,
    /// Angle of sun and rotor [rad].
    pub motor_angle: f64,
    /// [rad/s].
    pub motor_speed: f64,
    /// Angle of the carrier [rad].
    pub carrier_angle: f64,
    /// [rad/s].
    pub carrier_speed: f64,
    /// Angle of the link; equal to the carrier's without a compliance [rad].
    pub link_angle: f64,
    /// [rad/s].
    pub link_speed: f64,
    /// Rigid-body carrier angle, which no internal force changes [turns].
    pub rigid_turns: f64,
    /// Speed of the rigid-body carrier [rad/s].
    pub rigid_speed: f64,
    /// Sun angle less its rigid-body part; small, so that it keeps its digits at many turns [rad].
    pub motor_offset: f64,
    /// Link angle less the rigid-body carrier angle; keeps its digits at many turns [rad].
    pub link_offset: f64,
    /// Gap coordinate u_s - 2 u_c along the line of action [m].
    pub gap: f64,
    /// [m/s].
    pub gap_rate: f64,
    /// Wind-up u_c - u_l of carrier against link along the line of action; zero without compliance [m].
    pub wind_up: f64,
    /// [m/s].
    pub wind_up_rate: f64,
    /// Mesh deflections d = displacement - e [m].
    pub deflections: [PerPlanet; 2],
    /// [m/s].
    pub deflection_rates: [PerPlanet; 2],
    /// Mesh forces along the line of action [N].
    pub mesh_forces: [PerPlanet; 2],
    /// Flanks in contact.
    pub contacts: [Vec<ContactState, MAX_PLANETS>; 2],
    /// Torque from carrier to link; zero without compliance [N m].
    pub wind_up_torque: f64,
    /// Kinetic energy of all bodies [J].
    pub kinetic_energy: f64,
    /// Elastic energy in meshes and compliance [J].
    pub elastic_energy: f64,
    /// Work since the start.
    pub work: Work,
}

/// Work done since the start. Kinetic plus elastic energy grows by
/// `supplied - dissipated - against_errors + by_stiffness`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    /// Work of the drive torque less work taken by the load [J].
    pub supplied: f64,
    /// Energy dissipated in mesh damping and in the compliance [J].
    pub dissipated: f64,
    /// Work of the meshes against the imposed transmission errors [J].
    pub against_errors: f64,
    /// Work of the changing mesh stiffness [J].
    pub by_stiffness: f64,
}

impl Work {
    /// Expected growth of kinetic plus elastic energy [J].
    pub fn net(&self) -> f64 {
        self.supplied - self.dissipated - self.against_errors + self.by_stiffness
    }
}

impl Observation {
    /// Sum of elastic and damping forces of all sun-planet meshes [N].
    pub fn sun_force(&self) -> f64 {
        self.mesh_forces[0].iter().sum()
    }
}

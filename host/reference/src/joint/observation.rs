//! What can be read off the reference at one moment, in SI. Encoders, noise and delays are the drive train's.

use std::f64::consts::TAU;

use heapless::Vec;
use parameters::{ContactState, MAX_PLANETS, PerPlanet};

use super::Reference;
use super::equations::JointEquations;

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

    pub(super) fn read(reference: &Reference) -> Self {
        let equations = &reference.equations;
        let time = reference.integrator.time();
        let state = reference.integrator.state();
        let bodies = equations.bodies();
        let (positions, speeds) = (&state[..bodies], &state[bodies..2 * bodies]);
        let (carrier, link) = (equations.carrier(), equations.link());
        let (rigid, rigid_speed) = (equations.rigid(positions), equations.rigid(speeds));
        let whole_turns = reference.teeth_passed as f64 / equations.ring_teeth;
        let sun_lever = equations.sun_lever;
        let lever = equations.carrier_lever;
        // What the teeth that have been counted off come to, at the carrier [rad].
        let counted = TAU * whole_turns;
        let moment = equations.moment(time, state);

        let list = |kind: usize, value: &dyn Fn(usize) -> f64| -> PerPlanet {
            debug_assert!(kind < 2);
            (0..equations.planets).map(value).collect()
        };
        let both = |value: &dyn Fn(usize, usize) -> f64| [0, 1].map(|kind| list(kind, &|planet| value(kind, planet)));
        let kinetic = 0.5 * equations.masses.iter().zip(speeds).map(|(mass, speed)| mass * speed * speed).sum::<f64>();
        let in_meshes: f64 =
            moment.meshes.iter().flatten().map(|mesh| 0.5 * mesh.stiffness * mesh.overlap.powi(2)).sum();
        let wind_up = positions[carrier] - positions[link];
        let in_compliance = equations.compliance.map_or(0.0, |(stiffness, _)| 0.5 * stiffness * wind_up * wind_up);
        let work = &state[2 * bodies..];
        Self {
            time,
            motor_angle: positions[0] / sun_lever + counted * JointEquations::rigid_share(0) * lever / sun_lever,
            motor_speed: speeds[0] / sun_lever,
            carrier_angle: positions[carrier] / lever + counted,
            carrier_speed: speeds[carrier] / lever,
            link_angle: positions[link] / lever + counted,
            link_speed: speeds[link] / lever,
            rigid_turns: whole_turns + rigid / (lever * TAU),
            rigid_speed: rigid_speed / lever,
            motor_offset: (positions[0] - JointEquations::rigid_share(0) * rigid) / sun_lever,
            link_offset: (positions[link] - rigid) / lever,
            gap: positions[0] - 2.0 * positions[carrier],
            gap_rate: speeds[0] - 2.0 * speeds[carrier],
            wind_up,
            wind_up_rate: speeds[carrier] - speeds[link],
            deflections: both(&|kind, planet| moment.meshes[kind][planet].deflection),
            deflection_rates: both(&|kind, planet| moment.meshes[kind][planet].deflection_rate),
            mesh_forces: both(&|kind, planet| moment.meshes[kind][planet].force),
            contacts: [0, 1].map(|kind| {
                (0..equations.planets)
                    .map(|planet| equations.meshes[kind][planet].contact(moment.meshes[kind][planet].deflection))
                    .collect()
            }),
            wind_up_torque: moment.wind_up_force * lever,
            kinetic_energy: kinetic,
            elastic_energy: in_meshes + in_compliance,
            work: Work { supplied: work[0], dissipated: work[1], against_errors: work[2], by_stiffness: work[3] },
        }
    }
}

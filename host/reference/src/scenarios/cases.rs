//! The paper's joint under settings with independently known results: cases A and Q, stored as data files from an independent
//! integration, and the four regimes of set P. Dimensionless quantities are over b_c and omega_n.

use std::f64::consts::TAU;

use parameters::{JointParameters, MeshPhases, PerPlanet};

use super::joints::{PAPER_LENGTH, paper_joint, paper_natural_frequency};
use super::{Scenario, TorqueSegment};
use crate::joint::{Observation, RelativeState};

/// omega/omega_n of case A: meshes separate and collide, without chaos.
pub const CASE_A_OMEGA: f64 = 0.8;

/// omega/omega_n of case Q: contact holds.
pub const CASE_Q_OMEGA: f64 = 0.05;

/// Set P: omega/omega_n of the paper's four regimes.
const REGIME_OMEGA: f64 = 2.1;

/// Set P: chaos from this half-backlash up, and in windows from 35 um up [m].
const CHAOTIC_BACKLASH: f64 = 71e-6;

const TICK_RATE: u32 = 20_000;

/// Ticks up to a dimensionless time, at least.
fn ticks(tau: f64) -> u64 {
    (tau / paper_natural_frequency() * f64::from(TICK_RATE)).ceil() as u64
}

/// Case A, Q or one like them at another omega/omega_n, up to tau = 300: b = 60 um, E = 10 um, K_a/K_m = 0.2, mean
/// deflection of a mesh 15 um, planets a third of a mesh period apart.
pub fn case(name: &str, omega: f64) -> Scenario {
    let mut joint = paper_joint(0.2, 10e-6, 60e-6, omega);
    let thirds = |offset: f64| -> PerPlanet { (0..3).map(|planet| TAU * f64::from(planet) / 3.0 + offset).collect() };
    joint.sun_planet.phases = MeshPhases::Given { stiffness: thirds(0.4), error: thirds(0.0) };
    joint.ring_planet.phases = MeshPhases::Given { stiffness: thirds(2.3), error: thirds(0.7) };
    let force_per_mesh = 1e8 * 15e-6;
    let drive_torque = 3.0 * force_per_mesh * joint.geometry.sun_base_radius;
    let frequency = omega * paper_natural_frequency();
    let error = |phase: &f64| 10e-6 * phase.sin();
    let start = RelativeState {
        sun_planet: thirds(0.0).iter().map(|phase| 7.5 * PAPER_LENGTH - error(phase)).collect(),
        sun_planet_rate: thirds(0.0).iter().map(|phase| -10e-6 * frequency * phase.cos()).collect(),
        gap: 15.0 * PAPER_LENGTH,
        ..RelativeState::centred(3)
    };
    balanced(name, joint, start, drive_torque, 300.0, true)
}

/// Set P with a half-backlash [m], from X = X' = 0 up to a dimensionless time.
pub fn regime(name: &str, half_backlash: f64, tau: f64) -> Scenario {
    let joint = paper_joint(0.1, 30e-6, half_backlash, REGIME_OMEGA);
    balanced(name, joint, RelativeState::centred(3), 80.0, tau, half_backlash < CHAOTIC_BACKLASH)
}

/// X_sp of planet 0, X_sc, X_sp', X_sc' at the k-th Poincare section, tau = 2 pi k / Omega.
pub fn poincare_point(observation: &Observation) -> [f64; 4] {
    let speed = PAPER_LENGTH * paper_natural_frequency();
    [
        observation.deflections[0][0] / PAPER_LENGTH,
        observation.gap / PAPER_LENGTH,
        observation.deflection_rates[0][0] / speed,
        observation.gap_rate / speed,
    ]
}

/// Constant torques under which the rigid body does not accelerate: T_L = T_D 2 r_c cos(alpha) / r_bs.
fn balanced(
    name: &str,
    joint: JointParameters,
    start: RelativeState,
    drive_torque: f64,
    tau: f64,
    predictable: bool,
) -> Scenario {
    let geometry = &joint.geometry;
    let ratio = 2.0 * geometry.carrier_radius * geometry.working_pressure_angle.cos() / geometry.sun_base_radius;
    let load_torque = drive_torque * ratio;
    let torques = vec![TorqueSegment { from_tick: 0, drive_torque, load_torque }];
    Scenario { torques, ticks: ticks(tau), predictable, ..Scenario::new(name, joint, start) }
}

//! Fixed-step integration of eqs 1-6, for closed loops by the hundred: drift, kick, drift, of second order; contact
//! events are located to within one step. Work is not accumulated.

use parameters::MAX_PLANETS;

use super::equations::JointEquations;
use super::mesh_law::{MeshConstants, Phase};
use super::reference::Reference;
use crate::integrator::SwitchedSystem;

/// Highest frequency times the step; the teeth's frequency is at most 0.4 % too high.
const STEP: f64 = 0.3;

/// Excitation of a mesh, linear in time over a part of a period.
#[derive(Clone, Copy, Default)]
struct Excited {
    stiffness: f64,
    stiffness_rate: f64,
    error: f64,
    error_rate: f64,
    error_acceleration: f64,
}

impl Excited {
    fn new(mesh: &MeshConstants, phase: Phase) -> Self {
        let (stiffness, stiffness_rate) = mesh.stiffness(phase);
        let [error, error_rate, error_acceleration] = mesh.transmission_error(phase);
        Self { stiffness, stiffness_rate, error, error_rate, error_acceleration }
    }

    fn force(&self, mesh: &MeshConstants, displacement: f64, displacement_rate: f64, since: f64) -> f64 {
        let deflection = displacement - self.error - since * self.error_rate;
        let rate = displacement_rate - self.error_rate - since * self.error_acceleration;
        mesh.force(deflection, rate, self.stiffness + since * self.stiffness_rate)
    }
}

impl Reference {
    /// Advances to `time` [s] under constant torques as `advance` does, by equal steps that resolve the highest
    /// frequency of the teeth. Work is not accumulated.
    pub fn advance_by_fixed_steps(&mut self, time: f64, drive_torque: f64, load_torque: f64) {
        self.equations.drive_force = drive_torque / self.equations.sun_lever;
        self.equations.load_force = load_torque / self.equations.carrier_lever;
        self.count_teeth();
        let start = self.integrator.time();
        let span = time - start;
        let steps = (span * self.equations.highest_frequency / STEP).ceil().max(1.0);
        let step = span / steps;
        let equations = &self.equations;
        let state = self.integrator.state_mut();
        let phase = equations.phase(start, state);
        let mut excited = [[Excited::default(); MAX_PLANETS]; 2];
        for (kind, family) in equations.meshes.iter().enumerate() {
            for (planet, mesh) in family.iter().enumerate() {
                excited[kind][planet] = Excited::new(mesh, phase);
            }
        }
        let bodies = equations.bodies();
        let slip_entry = equations.slip_entry();
        let (positions, rest) = state.split_at_mut(bodies);
        let (speeds, rest) = rest.split_at_mut(bodies);
        let slipped = &mut rest[slip_entry - 2 * bodies];
        for index in 0..steps as u64 {
            drift(positions, speeds, 0.5 * step);
            advance_slip(equations, speeds, slipped, 0.5 * step);
            kick(equations, &excited, (positions, *slipped), speeds, (index as f64 + 0.5) * step, step);
            drift(positions, speeds, 0.5 * step);
            advance_slip(equations, speeds, slipped, 0.5 * step);
        }
        self.integrator.move_time(time);
        // The next observation uses the zones.
        self.equations.select_mode(time, self.integrator.state());
    }
}

fn drift(positions: &mut [f64], speeds: &[f64], step: f64) {
    for (position, speed) in positions.iter_mut().zip(speeds) {
        *position += step * speed;
    }
}

/// Advances the slipping part of the compliance.
fn advance_slip(equations: &JointEquations, speeds: &[f64], slipped: &mut f64, step: f64) {
    if let Some(slip) = equations.hysteresis {
        *slipped = slip.after(*slipped, step * (speeds[equations.carrier()] - speeds[equations.link()]));
    }
}

/// Changes the speeds by the forces at these positions and this deflection of the slipping part.
fn kick(
    equations: &JointEquations,
    excited: &[[Excited; MAX_PLANETS]; 2],
    (positions, slipped): (&[f64], f64),
    speeds: &mut [f64],
    since: f64,
    step: f64,
) {
    let (carrier, link) = (equations.carrier(), equations.link());
    let mut forces = [0.0; MAX_PLANETS + 3];
    forces[0] = equations.drive_force;
    let force = |kind: usize, planet: usize| {
        let displacement = equations.mesh_displacement(kind, planet, positions);
        let rate = equations.mesh_displacement(kind, planet, speeds);
        excited[kind][planet].force(&equations.meshes[kind][planet], displacement, rate, since)
    };
    for planet in 0..equations.planets {
        equations.apply(planet, force(0, planet), force(1, planet), &mut forces);
    }
    if let Some((stiffness, damping)) = equations.compliance {
        let mut wind_up =
            stiffness * (positions[carrier] - positions[link]) + damping * (speeds[carrier] - speeds[link]);
        if let Some(slip) = equations.hysteresis {
            wind_up += slip.stiffness * slipped;
        }
        forces[carrier] -= wind_up;
        forces[link] += wind_up;
    }
    forces[link] -= equations.load_force;
    for ((speed, force), mass) in speeds.iter_mut().zip(forces).zip(&equations.masses) {
        *speed += step * force / mass;
    }
}

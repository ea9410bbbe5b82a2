//! Eqs 1-6 of the paper in absolute coordinates along the line of action, u = angle times lever, for sun, planets,
//! carrier and, with a compliance, the link. No coordinate is eliminated: rigid body and teeth move in one state.
//!
//! Equations: (P1), (P2) in docs/theory/paper.md.

use heapless::Vec;
use parameters::{Excitation, MAX_PLANETS};

use super::hysteresis::Slip;
use super::mesh_law::{MeshConstants, MeshState, Phase, Zone};
use crate::integrator::{Entries, Guards, MAX_ENTRIES, SwitchedSystem};

/// Work entries at the end of the state: supplied, dissipated, done against transmission errors, by changing stiffness.
pub(super) const WORK_ENTRIES: usize = 4;

const SUN_PLANET: usize = 0;
const RING_PLANET: usize = 1;

/// Error tolerance of one step, relative to b_c (positions) and b_c omega (speeds).
const STEP_TOLERANCE: f64 = 1e-11;

/// Depth at which an event is detected, relative to b_c.
const EVENT_DEPTH: f64 = 1e-12;

/// Longest step times the highest frequency of stiffnesses, masses and excitation. Waves of this frequency have at most
/// one extremum per step, as the event search requires.
const LONGEST_STEP: f64 = 1.5;

/// Joint as masses on springs along the line of action.
#[derive(Debug, Clone)]
pub(super) struct JointEquations {
    pub planets: usize,
    /// Equivalent gear: its single planet has no mass and is not a body, so that both of its meshes carry equal forces.
    pub equivalent: bool,
    pub sun_lever: f64,
    pub carrier_lever: f64,
    pub ring_teeth: f64,
    pub length: f64,
    /// Equivalent masses in the order of the state: sun, planets, carrier, and the link if it is a separate body.
    pub masses: Vec<f64, { MAX_PLANETS + 3 }>,
    /// Part of the last body's mass that belongs to the link.
    pub link_mass: f64,
    /// Sum of the crest stiffnesses of all springs at the last body.
    pub link_stiffness: f64,
    /// Stiffness and damping between carrier and link.
    pub compliance: Option<(f64, f64)>,
    /// Slipping part of the stiffness between carrier and link; its deflection follows the work entries in the state.
    pub hysteresis: Option<Slip>,
    pub meshes: [Vec<MeshConstants, MAX_PLANETS>; 2],
    pub zones: [[Zone; MAX_PLANETS]; 2],
    pub excitation: Excitation,
    /// Upper bound of the highest natural frequency with teeth in contact [rad/s].
    pub highest_frequency: f64,
    /// Highest harmonic of the stiffness waves.
    pub harmonics: f64,
    /// Phase rate at the last selection of the zones [rad/s].
    pub phase_rate: f64,
    /// T_D / r_bs.
    pub drive_force: f64,
    /// T_L / (r_c cos alpha).
    pub load_force: f64,
}

/// State of every mesh, and the force between carrier and link, at one time.
pub(super) struct InternalForces {
    pub meshes: [[MeshState; MAX_PLANETS]; 2],
    pub wind_up_force: f64,
}

impl JointEquations {
    pub fn bodies(&self) -> usize {
        self.masses.len()
    }

    pub fn carrier(&self) -> usize {
        if self.equivalent { 1 } else { self.planets + 1 }
    }

    /// Index of the last body: the link, or the carrier with the link rigidly attached.
    pub fn link(&self) -> usize {
        self.bodies() - 1
    }

    /// Displacement of a body along the line of action per displacement of the carrier in rigid motion, in which no
    /// mesh deflects.
    pub fn rigid_share(body: usize) -> f64 {
        if body == 0 { 2.0 } else { 1.0 }
    }

    /// Rigid-body coordinate, which no internal force changes: the mass-weighted mean of `values` over the rigid
    /// shares.
    pub fn rigid(&self, values: &[f64]) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (body, mass) in self.masses.iter().enumerate() {
            let share = Self::rigid_share(body);
            sum += share * mass * values[body];
            weight += share * share * mass;
        }
        sum / weight
    }

    /// Phase of the excitation (mode `angle`: ring teeth times the rigid-body carrier angle).
    pub fn phase(&self, time: f64, state: &Entries) -> Phase {
        match self.excitation {
            Excitation::Time { mesh_frequency } => {
                Phase { angle: mesh_frequency * time, rate: mesh_frequency, acceleration: 0.0 }
            }
            Excitation::Angle => {
                let per_length = self.ring_teeth / self.carrier_lever;
                let mut accelerations = [0.0; MAX_PLANETS + 3];
                accelerations[0] = self.drive_force / self.masses[0];
                accelerations[self.link()] = -self.load_force / self.masses[self.link()];
                Phase {
                    angle: per_length * self.rigid(state),
                    rate: per_length * self.rigid(&state[self.bodies()..]),
                    acceleration: per_length * self.rigid(&accelerations),
                }
            }
        }
    }

    /// Displacement across a mesh (eq. 4 without its error), of positions, speeds or accelerations alike.
    pub fn mesh_displacement(&self, kind: usize, planet: usize, values: &[f64]) -> f64 {
        let carrier = values[self.carrier()];
        if self.equivalent {
            return 0.5 * values[0] - carrier;
        }
        match kind {
            SUN_PLANET => values[0] - values[1 + planet] - carrier,
            _ => values[1 + planet] - carrier,
        }
    }

    /// Adds the forces of one planet's meshes to those on the bodies.
    pub fn apply(&self, planet: usize, sun_planet: f64, ring_planet: f64, forces: &mut [f64]) {
        let both = sun_planet + ring_planet;
        if self.equivalent {
            forces[0] -= 0.5 * both;
        } else {
            forces[0] -= sun_planet;
            forces[1 + planet] += sun_planet - ring_planet;
        }
        forces[self.carrier()] += both;
    }

    /// Index of the slipping part's deflection in the state.
    pub fn slip_entry(&self) -> usize {
        2 * self.bodies() + WORK_ENTRIES
    }

    pub fn internal_forces(&self, time: f64, state: &Entries) -> InternalForces {
        let phase = self.phase(time, state);
        let speeds = &state[self.bodies()..];
        let mut meshes = [[MeshState::default(); MAX_PLANETS]; 2];
        for (kind, family) in self.meshes.iter().enumerate() {
            for (planet, mesh) in family.iter().enumerate() {
                let (position, speed) =
                    (self.mesh_displacement(kind, planet, state), self.mesh_displacement(kind, planet, speeds));
                meshes[kind][planet] = mesh.state(self.zones[kind][planet], position, speed, phase);
            }
        }
        let mut wind_up_force = self.compliance.map_or(0.0, |(stiffness, damping)| {
            let (carrier, link) = (self.carrier(), self.link());
            stiffness * (state[carrier] - state[link]) + damping * (speeds[carrier] - speeds[link])
        });
        if let Some(slip) = self.hysteresis {
            wind_up_force += slip.stiffness * state[self.slip_entry()];
        }
        InternalForces { meshes, wind_up_force }
    }
}

impl SwitchedSystem for JointEquations {
    fn dimension(&self) -> usize {
        self.slip_entry() + usize::from(self.hysteresis.is_some())
    }

    fn derivative(&self, time: f64, state: &Entries, rates: &mut Entries) {
        let bodies = self.bodies();
        let (carrier, link) = (self.carrier(), self.link());
        let speeds = &state[bodies..2 * bodies];
        let internal = self.internal_forces(time, state);
        let mut forces = [0.0; MAX_PLANETS + 3];
        let (mut dissipated, mut against_errors, mut by_stiffness) = (0.0, 0.0, 0.0);
        forces[0] += self.drive_force;
        for planet in 0..self.planets {
            let sun_planet = &internal.meshes[SUN_PLANET][planet];
            let ring_planet = &internal.meshes[RING_PLANET][planet];
            self.apply(planet, sun_planet.force, ring_planet.force, &mut forces);
            for mesh in [sun_planet, ring_planet] {
                dissipated += (mesh.force - mesh.stiffness * mesh.overlap) * mesh.deflection_rate;
                against_errors += mesh.force * mesh.error_rate;
                by_stiffness += 0.5 * mesh.stiffness_rate * mesh.overlap * mesh.overlap;
            }
        }
        if let Some((_, damping)) = self.compliance {
            forces[carrier] -= internal.wind_up_force;
            forces[link] += internal.wind_up_force;
            dissipated += damping * (speeds[carrier] - speeds[link]).powi(2);
        }
        if let Some(slip) = self.hysteresis {
            let (deflection, rate) = (state[self.slip_entry()], speeds[carrier] - speeds[link]);
            rates[self.slip_entry()] = slip.rate(deflection, rate);
            dissipated += slip.loss(deflection, rate);
        }
        forces[link] -= self.load_force;
        for body in 0..bodies {
            rates[body] = speeds[body];
            rates[bodies + body] = forces[body] / self.masses[body];
        }
        let supplied = self.drive_force * speeds[0] - self.load_force * speeds[link];
        rates[2 * bodies..2 * bodies + WORK_ENTRIES].copy_from_slice(&[
            supplied,
            dissipated,
            against_errors,
            by_stiffness,
        ]);
    }

    fn select_mode(&mut self, time: f64, state: &Entries) {
        let phase = self.phase(time, state);
        self.phase_rate = phase.rate;
        let speeds = &state[self.bodies()..];
        for kind in [SUN_PLANET, RING_PLANET] {
            for planet in 0..self.planets {
                let mesh = &self.meshes[kind][planet];
                let [error, error_rate, _] = mesh.transmission_error(phase);
                let deflection = self.mesh_displacement(kind, planet, state) - error;
                let rate = self.mesh_displacement(kind, planet, speeds) - error_rate;
                self.zones[kind][planet] = mesh.zone(deflection, rate, mesh.stiffness(phase).0);
            }
        }
    }

    fn guards(&self, time: f64, state: &Entries, rates: &Entries, guards: &mut Guards) {
        let phase = self.phase(time, state);
        let internal = self.internal_forces(time, state);
        let accelerations = &rates[self.bodies()..];
        for (kind, family) in self.meshes.iter().enumerate() {
            for (planet, mesh) in family.iter().enumerate() {
                let acceleration =
                    self.mesh_displacement(kind, planet, accelerations) - mesh.transmission_error(phase)[2];
                mesh.watch(self.zones[kind][planet], &internal.meshes[kind][planet], acceleration, guards);
            }
        }
    }

    fn guard_resolution(&self) -> f64 {
        EVENT_DEPTH * self.length
    }

    fn tolerance(&self, entry: usize) -> f64 {
        if entry < self.bodies() {
            STEP_TOLERANCE * self.length
        } else if entry < 2 * self.bodies() {
            STEP_TOLERANCE * self.length * self.highest_frequency
        } else if entry == self.slip_entry() {
            STEP_TOLERANCE * self.length
        } else {
            // The works follow from the motion and do not limit the step.
            f64::INFINITY
        }
    }

    fn longest_step(&self) -> f64 {
        LONGEST_STEP / self.highest_frequency.max(self.harmonics * self.phase_rate.abs())
    }
}

const _: () = assert!(2 * (MAX_PLANETS + 3) + WORK_ENTRIES < MAX_ENTRIES);

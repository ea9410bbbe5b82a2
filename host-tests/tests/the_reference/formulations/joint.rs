//! Dimensionless parameters of the joint and forces of excited meshes, for the formulations integrated here: written out independently of
//! the core's tables and of the reference.

use std::array;

use parameters::{JointParameters, MAX_PLANETS, MeshPhases, StiffnessWave};
use reference::integrator::{Entries, Guards, SwitchedSystem};
use reference::scenarios::{PAPER_LENGTH, paper_natural_frequency};

/// Dimensionless excitation frequency omega / omega_n.
pub const OMEGA: f64 = 0.8;

/// Sun-planet deflections of every planet, then ring-planet, over b_c.
pub type Deflections = [Vec<f64>; 2];

/// Parameters of a mesh: K_m / omega_n^2 [kg], C / omega_n [kg], and lengths over b_c.
#[derive(Clone, Copy, Default)]
pub struct Mesh {
    pub stiffness: f64,
    pub damping: f64,
    pub half_backlash: f64,
    ripple: f64,
    ripple_phase: f64,
    error: f64,
    error_phase: f64,
}

/// Deflection of a mesh and its rate.
#[derive(Clone, Copy, Default)]
pub struct MeshMotion {
    pub deflection: f64,
    pub rate: f64,
}

/// Equations of motion of the joint in coordinates of their own.
pub trait Formulation {
    /// Initial state with X = X' = 0, where the reference starts.
    fn start(&self, joint: &Joint) -> Entries;

    /// Deflections and their rates in a state.
    fn meshes(&self, joint: &Joint, time: f64, state: &Entries) -> [[MeshMotion; MAX_PLANETS]; 2];

    /// Derivative of a state with the contact sides held.
    fn derivative(&self, joint: &Joint, time: f64, state: &Entries, rates: &mut Entries);
}

/// Joint and formulation, as a system for the reference's integrator.
pub struct System<F> {
    pub joint: Joint,
    pub formulation: F,
}

impl<F: Formulation> System<F> {
    fn meshes(&self, time: f64, state: &Entries) -> [[MeshMotion; MAX_PLANETS]; 2] {
        self.formulation.meshes(&self.joint, time, state)
    }

    pub fn deflections(&self, time: f64, state: &Entries) -> Deflections {
        self.joint.to_deflections(&self.meshes(time, state))
    }
}

impl<F: Formulation> SwitchedSystem for System<F> {
    fn dimension(&self) -> usize {
        2 * (self.joint.planets + 1)
    }

    fn derivative(&self, time: f64, state: &Entries, rates: &mut Entries) {
        self.formulation.derivative(&self.joint, time, state, rates);
    }

    fn select_mode(&mut self, time: f64, state: &Entries) {
        let meshes = self.meshes(time, state);
        self.joint.select_sides(&meshes);
    }

    fn guards(&self, time: f64, state: &Entries, _: &Entries, guards: &mut Guards) {
        self.joint.add_guards(&self.meshes(time, state), guards);
    }

    fn guard_resolution(&self) -> f64 {
        1e-12
    }

    fn tolerance(&self, _: usize) -> f64 {
        1e-12
    }

    fn longest_step(&self) -> f64 {
        0.5
    }
}

/// Masses, meshes and torques.
#[derive(Clone)]
pub struct Joint {
    pub planets: usize,
    pub sun: f64,
    pub planet: f64,
    pub carrier: f64,
    pub meshes: [[Mesh; MAX_PLANETS]; 2],
    /// Drive term T_D / (M_s r_bs omega_n^2 b_c).
    pub drive: f64,
    /// Load term T_L / (M_c r_c cos(alpha) omega_n^2 b_c).
    pub load: f64,
    omega: f64,
    /// Side of each dead zone, held until the next event: 1, 0, -1.
    pub sides: [[f64; MAX_PLANETS]; 2],
}

impl Joint {
    /// The paper's masses with the meshes of `parameters`, under balanced torques.
    pub fn new(parameters: &JointParameters, drive_torque: f64) -> Self {
        let frequency = paper_natural_frequency();
        let square = frequency.powi(2);
        let planets = parameters.geometry.planets;
        let (sun, planet) = (0.39, 0.61);
        let cosine = 24.6_f64.to_radians().cos();
        let carrier = (6.29 + planets as f64 * 0.66) / cosine.powi(2);
        let families = [(&parameters.sun_planet, sun * planet / (sun + planet)), (&parameters.ring_planet, planet)];
        let meshes = families.map(|(mesh, reduced)| {
            let MeshPhases::Given { stiffness, error } = &mesh.phases else { panic!("phases are given here") };
            let StiffnessWave::Harmonic { stiffness_ratio } = mesh.stiffness_wave else { panic!("one harmonic here") };
            array::from_fn(|i| {
                if i >= planets {
                    return Mesh::default();
                }
                Mesh {
                    stiffness: mesh.mean_stiffness / square,
                    damping: 2.0 * mesh.damping_ratio * (mesh.mean_stiffness * reduced).sqrt() / frequency,
                    half_backlash: mesh.half_backlash[i] / PAPER_LENGTH,
                    ripple: stiffness_ratio,
                    ripple_phase: stiffness[i],
                    error: mesh.transmission_error[i] / PAPER_LENGTH,
                    error_phase: error[i],
                }
            })
        });
        let drive_force = drive_torque / 36.8241e-3;
        let unit = square * PAPER_LENGTH;
        let (drive, load) = (drive_force / (sun * unit), 2.0 * drive_force / (carrier * unit));
        let omega = OMEGA;
        Self { planets, sun, planet, carrier, meshes, drive, load, omega, sides: [[0.0; MAX_PLANETS]; 2] }
    }

    /// Error e of a mesh with e' and e'' (eq. 11).
    pub fn error(&self, kind: usize, i: usize, time: f64) -> [f64; 3] {
        let mesh = &self.meshes[kind][i];
        let (sine, cosine) = (self.omega * time + mesh.error_phase).sin_cos();
        [mesh.error * sine, mesh.error * self.omega * cosine, -mesh.error * self.omega.powi(2) * sine]
    }

    /// Elastic force K f(d, b) of a mesh (eqs 7 and 12) on the held side.
    pub fn elastic(&self, kind: usize, i: usize, time: f64, deflection: f64) -> f64 {
        let mesh = &self.meshes[kind][i];
        let side = self.sides[kind][i];
        let stiffness = mesh.stiffness * (1.0 + mesh.ripple * (self.omega * time + mesh.ripple_phase).sin());
        stiffness * side.abs() * (deflection - side * mesh.half_backlash)
    }

    /// Sets the sides from the deflections.
    pub fn select_sides(&mut self, meshes: &[[MeshMotion; MAX_PLANETS]; 2]) {
        for (kind, i) in self.mesh_indices() {
            let (deflection, half_backlash) = (meshes[kind][i].deflection, self.meshes[kind][i].half_backlash);
            self.sides[kind][i] = if deflection.abs() > half_backlash { deflection.signum() } else { 0.0 };
        }
    }

    /// Adds guards that stay positive while the sides hold.
    pub fn add_guards(&self, meshes: &[[MeshMotion; MAX_PLANETS]; 2], guards: &mut Guards) {
        for (kind, i) in self.mesh_indices() {
            let MeshMotion { deflection, rate } = meshes[kind][i];
            let (half_backlash, side) = (self.meshes[kind][i].half_backlash, self.sides[kind][i]);
            if side == 0.0 {
                guards.watch(half_backlash - deflection, -rate);
                guards.watch(half_backlash + deflection, rate);
            } else {
                guards.watch(side * deflection - half_backlash, side * rate);
            }
        }
    }

    /// Indices (kind, planet) of every mesh.
    pub fn mesh_indices(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let planets = self.planets;
        (0..2).flat_map(move |kind| (0..planets).map(move |i| (kind, i)))
    }

    /// Deflections in the reference's order.
    pub fn to_deflections(&self, meshes: &[[MeshMotion; MAX_PLANETS]; 2]) -> Deflections {
        meshes.map(|family| family[..self.planets].iter().map(|mesh| mesh.deflection).collect())
    }
}

//! The joint as plain dimensionless numbers (lengths over b_c, times by omega_n, forces over K_m b_c) for one step
//! size. Printed by `Debug`, a plant is the Rust expression that makes it, so that a board can carry it.

use model_core::numbers::Real;
use parameters::MAX_HARMONICS;

/// A joint with `N` planets.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant<T: Real, const N: usize> {
    /// The step h omega_n.
    pub step: T,
    /// Acceleration of the sun (with rotor) under a unit force.
    pub sun: T,
    /// Of a planet.
    pub planet: T,
    /// Of the carrier; with the link unless compliant.
    pub carrier: T,
    /// Of the link; zero unless compliant.
    pub link: T,
    /// Whether there is a spring between carrier and link.
    pub compliant: bool,
    /// Its stiffness and damping.
    pub wind_up: [T; 2],
    /// Mesh damping: sun-planet, ring-planet.
    pub damping: [T; 2],
    /// What a mesh does when its teeth part.
    pub law: Law,
    /// Sharpness of the tanh dead zone; only read under the smooth laws.
    pub sharpness: T,
    /// Sun-planet of every planet, then ring-planet.
    pub meshes: [[Mesh<T>; N]; 2],
    /// Harmonics of the stiffness wave in use.
    pub harmonics: usize,
    /// From torques to accelerations.
    pub gains: Gains<T>,
    /// How the mesh phase goes.
    pub phase: Phase<T>,
    /// Exponential flow of the closed joint over the step.
    pub flow: Flow<T>,
}

/// Exponential flow of the closed joint at mean stiffness, what planets do together apart from what each does beside their
/// mean. In-phase state: mean planet, gap, wind-up, then their rates. Transitions are less the identity; lists go by rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow<T: Real> {
    /// In-phase motion.
    pub in_phase: [[T; 6]; 6],
    /// Its response to forces missing from all sun-planet and all ring-planet meshes together, constant over the step.
    pub missing: [[T; 2]; 6],
    /// To accelerations of sun, carrier and link.
    pub torques: [[T; 3]; 6],
    /// Deviation of a planet and its rate.
    pub deviation: [[T; 2]; 2],
    /// Their response to the deviation of (sun-planet - ring-planet) of what is missing.
    pub missing_deviation: [T; 2],
    /// Mean stiffness of sun-planet and ring-planet meshes.
    pub stiffness: [T; 2],
    /// 1 / N.
    pub share: T,
}

/// What a mesh does when its teeth part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Sharp dead zone; damping always acts.
    Always,
    /// Sharp dead zone; teeth only push.
    Push,
    /// Dead zone by tanh (eq. 13); damping always acts.
    Smooth,
    /// Dead zone by tanh; damping fades with it, and teeth only push.
    SmoothPush,
}

impl Law {
    /// The same law with a dead zone by tanh.
    pub fn smoothed(self) -> Self {
        match self {
            Self::Always | Self::Smooth => Self::Smooth,
            Self::Push | Self::SmoothPush => Self::SmoothPush,
        }
    }
}

/// One mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mesh<T: Real> {
    /// Half-backlash b.
    pub half_backlash: T,
    /// Imposed error = sine * sin(phase) + cosine * cos(phase).
    pub error: [T; 2],
    /// Mean stiffness.
    pub stiffness: T,
    /// Stiffness wave beside the mean, [sine, cosine] of each harmonic.
    pub ripple: [[T; 2]; MAX_HARMONICS],
}

/// From torques in N m to dimensionless accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains<T: Real> {
    /// Of the sun, for the drive torque.
    pub sun: T,
    /// Of the carrier, for the load torque; zero when compliant.
    pub carrier: T,
    /// Of the link, for the load torque; zero unless compliant.
    pub link: T,
    /// Of the rigid body for drive and load torque, in 2^-64 carrier turns a step, each step.
    pub rigid: [T; 2],
}

/// How the mesh phase goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase<T: Real> {
    /// Prescribed in time: what a step adds, in 2^-64 periods. Zero if the carrier's angle makes the phase.
    pub step: u64,
    /// Mesh periods of a carrier turn; zero if the phase is prescribed.
    pub periods_per_turn: u32,
    /// Radians a unit of dimensionless time: in all if prescribed, else for each 2^-32 carrier turns a step.
    pub rate: T,
    /// [sine, cosine] of what half a step adds, if prescribed.
    pub half_turn: [T; 2],
    /// Of what a step adds.
    pub turn: [T; 2],
}

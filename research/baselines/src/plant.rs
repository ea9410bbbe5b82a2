//! The joint as plain dimensionless numbers (lengths over b_c, times by omega_n, forces over K_m b_c) for one step size. The `Debug` form
//! of a plant is the Rust expression that makes it, so that a board can contain it.

use model_core::numbers::Real;
use parameters::MAX_HARMONICS;

/// Joint with `N` planets.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant<T: Real, const N: usize> {
    /// Step h omega_n.
    pub step: T,
    /// Acceleration of the sun (with rotor) under a unit force.
    pub sun: T,
    /// Acceleration of a planet under a unit force.
    pub planet: T,
    /// Acceleration of the carrier under a unit force; with the link unless compliant.
    pub carrier: T,
    /// Acceleration of the link under a unit force; zero unless compliant.
    pub link: T,
    /// True if there is a spring between carrier and link.
    pub compliant: bool,
    /// Stiffness and damping of the spring between carrier and link.
    pub wind_up: [T; 2],
    /// Mesh damping: sun-planet, ring-planet.
    pub damping: [T; 2],
    /// Force law of separated teeth.
    pub law: Law,
    /// Sharpness of the tanh dead zone; used by the smooth laws only.
    pub sharpness: T,
    /// Meshes: sun-planet of every planet, then ring-planet.
    pub meshes: [[Mesh<T>; N]; 2],
    /// Number of harmonics of the stiffness wave in use.
    pub harmonics: usize,
    /// Gains from torques to accelerations.
    pub gains: Gains<T>,
    /// Course of the mesh phase.
    pub phase: Phase<T>,
    /// Exponential flow of the closed joint over the step.
    pub flow: Flow<T>,
}

/// Exponential flow of the closed joint at mean stiffness, with the planets' mean apart from their deviations. In-phase state: mean planet,
/// gap, wind-up, then their rates. Transitions have the identity subtracted; lists go by rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow<T: Real> {
    /// Transition of the in-phase motion.
    pub in_phase: [[T; 6]; 6],
    /// In-phase response to forces missing from all sun-planet and all ring-planet meshes together, constant over the step.
    pub missing: [[T; 2]; 6],
    /// In-phase response to accelerations of sun, carrier and link.
    pub torques: [[T; 3]; 6],
    /// Transition of a planet's deviation and its rate.
    pub deviation: [[T; 2]; 2],
    /// Deviation response to the deviation of the missing forces (sun-planet - ring-planet).
    pub missing_deviation: [T; 2],
    /// Mean stiffness of sun-planet and ring-planet meshes.
    pub stiffness: [T; 2],
    /// Share 1 / N of one planet.
    pub share: T,
}

/// Force law of separated teeth.
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
    /// Law with a tanh dead zone in place of a sharp one.
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
    /// Stiffness wave without its mean, [sine, cosine] of each harmonic.
    pub ripple: [[T; 2]; MAX_HARMONICS],
}

/// Gains from torques in N m to dimensionless accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains<T: Real> {
    /// Gain of the sun for the drive torque.
    pub sun: T,
    /// Gain of the carrier for the load torque; zero when compliant.
    pub carrier: T,
    /// Gain of the link for the load torque; zero unless compliant.
    pub link: T,
    /// Gains of the rigid body for drive and load torque, in 2^-64 carrier turns a step, each step.
    pub rigid: [T; 2],
}

/// Course of the mesh phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase<T: Real> {
    /// Phase increment of a step if prescribed in time [2^-64 periods]; zero if the carrier's angle determines the phase.
    pub step: u64,
    /// Mesh periods of a carrier turn; zero if the phase is prescribed.
    pub periods_per_turn: u32,
    /// Phase rate [rad per unit of dimensionless time]: total if prescribed, else for each 2^-32 carrier turns a step.
    pub rate: T,
    /// [sine, cosine] of the phase increment of half a step, if prescribed.
    pub half_turn: [T; 2],
    /// [sine, cosine] of the phase increment of a step, if prescribed.
    pub turn: [T; 2],
}

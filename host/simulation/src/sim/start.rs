//! Initial state of a run, equal for every scheme: at rest like a board after a reset, in the middle of the gap as in
//! the paper, or seated under the first torques.

use std::array;

use clap::ValueEnum;
use model_core::gears::{Kinematics, MeshPhasing, Relative, Scales, State, Tables};
use model_core::numbers::Real;
use parameters::{Excitation, JointParameters, MESH_KINDS, MeshKind, PerPlanet};
use reference::joint::{RelativeState, Start};

/// Values of `--start`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StartName {
    /// No deflection, like a board after its reset
    Rest,
    /// X = X' = 0: every tooth in the middle of its gap, as in the paper
    Centred,
    /// Teeth on their flanks under the first torques
    Seated,
}

impl StartName {
    /// Word on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Centred => "centred",
            Self::Seated => "seated",
        }
    }

    /// Initial state of a joint with a carrier speed [rad/s] under torques (drive, load) [N m].
    pub fn state(self, joint: &JointParameters, speed: f64, torques: (f64, f64)) -> Start {
        let planets = joint.geometry.planets;
        match self {
            Self::Rest if speed == 0.0 => Start::Still,
            Self::Rest => Start::Relative(at_rest(joint, speed)),
            Self::Centred => Start::Relative(RelativeState { rigid_speed: speed, ..RelativeState::centred(planets) }),
            Self::Seated => Start::Relative(seated(joint, speed, torques)),
        }
    }
}

/// Undeflected bodies: the deflections are the negated transmission errors.
fn at_rest(joint: &JointParameters, speed: f64) -> RelativeState {
    let planets = joint.geometry.planets;
    let phase_rate = match joint.excitation {
        Excitation::Time { mesh_frequency } => mesh_frequency,
        Excitation::Angle => f64::from(joint.geometry.ring_teeth) * speed,
    };
    let amplitude = |planet: usize| joint.sun_planet.transmission_error[planet];
    let phase = |planet: usize| joint.error_phase(MeshKind::SunPlanet, planet);
    RelativeState {
        sun_planet: (0..planets).map(|planet| -amplitude(planet) * phase(planet).sin()).collect(),
        sun_planet_rate: (0..planets).map(|planet| -phase_rate * amplitude(planet) * phase(planet).cos()).collect(),
        rigid_speed: speed,
        ..RelativeState::centred(planets)
    }
}

/// Static equilibrium at mean stiffness with equal sharing among planets, without relative motion of the bodies.
fn seated(joint: &JointParameters, speed: f64, (drive, load): (f64, f64)) -> RelativeState {
    let planets = joint.geometry.planets;
    let force = drive / (planets as f64 * joint.geometry.sun_base_radius);
    let reach = |kind: MeshKind| -> PerPlanet {
        let mesh = joint.mesh(kind);
        let touch = |half_backlash: &f64| half_backlash.copysign(force) + force / mesh.mean_stiffness;
        mesh.half_backlash.iter().map(touch).collect()
    };
    let [sun, ring] = MESH_KINDS.map(reach);
    let gaps = sun.iter().zip(&ring).map(|(sun, ring)| sun + ring);
    let still = at_rest(joint, speed);
    let lever = joint.geometry.carrier_base_radius();
    RelativeState {
        gap: gaps.sum::<f64>() / planets as f64,
        wind_up: joint.compliance.map_or(0.0, |compliance| load / compliance.stiffness * lever),
        // The bodies move together, so the deflections change at the rates of the errors.
        sun_planet: sun,
        ..still
    }
}

/// Initial state for the core.
pub fn core_state<T: Real, const N: usize>(
    joint: &JointParameters,
    tables: &Tables<T, N>,
    start: &Start,
) -> State<T, N> {
    let Start::Relative(start) = start else { return State::REST };
    let scales = Scales::new(joint);
    let relative = |planets: &[f64], gap: f64, wind_up: f64, unit: f64| Relative {
        planets: array::from_fn(|i| T::from_f64(planets[i] / unit)),
        gap: T::from_f64(gap / unit),
        wind_up: T::from_f64(if joint.compliance.is_some() { wind_up / unit } else { 0.0 }),
    };
    let speed = scales.length * scales.frequency;
    State::from_deflections(
        tables,
        &relative(&start.sun_planet, start.gap, start.wind_up, scales.length),
        &relative(&start.sun_planet_rate, start.gap_rate, start.wind_up_rate, speed),
        T::from_f64(start.rigid_speed),
    )
}

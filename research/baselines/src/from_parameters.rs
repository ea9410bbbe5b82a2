//! Plants from joint parameters, in f64. The dimensionless bodies come from the core's `gears::design::dynamics`, which the independent
//! reference verifies; meshes and phase are computed here for the baselines' own layout.

use core::array;
use core::f64::consts::TAU;

use model_core::gears::design::dynamics::{Dynamics, MovingMasses};
use model_core::gears::design::exponential;
use model_core::gears::{Kinematics, Mechanics, MeshPhasing, Scales, StiffnessSeries};
use model_core::numbers::Real;
use nalgebra::DMatrix;
use parameters::{DampingLaw, DeadZone, Excitation, JointParameters, MAX_HARMONICS, MESH_KINDS, MeshKind};

use crate::motion::Coordinates;
use crate::peer::Start;
use crate::plant::{Flow, Gains, Law, Mesh, Phase, Plant};
use crate::two_mass::{Contact, TwoMass};

/// 2^64 and 2^32 as floating-point numbers.
const WHOLE: f64 = 18_446_744_073_709_551_616.0;
const HALF_WHOLE: f64 = 4_294_967_296.0;

impl<T: Real, const N: usize> Plant<T, N> {
    /// Plant of a joint at `rate` steps a second. `N` must be the joint's number of planets.
    pub fn new(parameters: &JointParameters, rate: f64) -> Self {
        let real = T::from_f64;
        let scales = Scales::new(parameters);
        let dynamics = Dynamics::new(parameters, &scales);
        let step = scales.frequency / rate;
        let compliant = dynamics.wind_up.is_some();
        let mobility = |body: usize| real(dynamics.mobilities.get(body).copied().unwrap_or(0.0));
        let (stiffness, damping) = dynamics.wind_up.unwrap_or((0.0, 0.0));
        Self {
            step: real(step),
            sun: mobility(0),
            planet: mobility(1),
            carrier: mobility(N + 1),
            link: if compliant { mobility(N + 2) } else { T::ZERO },
            compliant,
            wind_up: [real(stiffness), real(damping)],
            damping: MESH_KINDS.map(|kind| real(scales.damping(parameters.damping_coefficient(kind)))),
            law: match (parameters.dead_zone, parameters.damping_law) {
                (DeadZone::Sharp, DampingLaw::Paper) => Law::Always,
                (DeadZone::Sharp, DampingLaw::Contact) => Law::Push,
                // As in the core: with the tanh dead zone there is no end of contact.
                (DeadZone::Tanh { .. }, _) => Law::Smooth,
            },
            sharpness: match parameters.dead_zone {
                DeadZone::Sharp => T::ZERO,
                DeadZone::Tanh { sharpness } => real(sharpness),
            },
            meshes: MESH_KINDS.map(|kind| array::from_fn(|planet| mesh(parameters, &scales, kind, planet))),
            harmonics: MESH_KINDS
                .map(|kind| parameters.mesh(kind).stiffness_wave.order())
                .into_iter()
                .max()
                .unwrap_or(1),
            gains: gains(parameters, &scales, rate),
            phase: phase(parameters, rate, step),
            flow: flow::<T, N>(&dynamics, step, parameters, &scales),
        }
    }
}

fn gains<T: Real>(parameters: &JointParameters, scales: &Scales, rate: f64) -> Gains<T> {
    let masses = MovingMasses::new(parameters);
    let (sun_lever, lever) = (parameters.geometry.sun_base_radius, parameters.geometry.carrier_base_radius());
    let gain = |lever: f64, mass: f64| 1.0 / (lever * mass * scales.acceleration());
    // Turns per step and step [2^-64 carrier turns] for a unit of rigid acceleration [m/s^2].
    let turns = WHOLE / (TAU * lever * rate * rate);
    let rigid_mass = masses.rigid(parameters.geometry.planets);
    Gains {
        sun: T::from_f64(gain(sun_lever, masses.sun)),
        carrier: T::from_f64(if masses.link.is_some() { 0.0 } else { gain(lever, masses.carrier) }),
        link: T::from_f64(masses.link.map_or(0.0, |link| gain(lever, link))),
        rigid: [2.0 / sun_lever, 1.0 / lever].map(|per_torque| T::from_f64(turns * per_torque / rigid_mass)),
    }
}

fn phase<T: Real>(parameters: &JointParameters, rate: f64, step: f64) -> Phase<T> {
    match parameters.excitation {
        Excitation::Time { mesh_frequency } => {
            let periods = mesh_frequency / (TAU * rate);
            let half = 0.5 * TAU * periods;
            Phase {
                step: (periods.fract() * WHOLE) as u64,
                periods_per_turn: 0,
                rate: T::from_f64(TAU * periods / step),
                half_turn: [half.sin(), half.cos()].map(T::from_f64),
                turn: [(2.0 * half).sin(), (2.0 * half).cos()].map(T::from_f64),
            }
        }
        Excitation::Angle => {
            let teeth = parameters.geometry.ring_teeth;
            let rate = T::from_f64(TAU * f64::from(teeth) / (HALF_WHOLE * step));
            let still = [T::ZERO, T::ONE];
            Phase { step: 0, periods_per_turn: teeth, rate, half_turn: still, turn: still }
        }
    }
}

/// Flow of v' = A v + B u with v = (x, x'), from the core's precise integration, split into the planets' mean and deviations.
fn flow<T: Real, const N: usize>(
    dynamics: &Dynamics,
    step: f64,
    parameters: &JointParameters,
    scales: &Scales,
) -> Flow<T> {
    let size = dynamics.coordinates();
    let mut matrix = DMatrix::zeros(2 * size, 2 * size);
    matrix.view_mut((0, size), (size, size)).fill_with_identity();
    matrix.view_mut((size, 0), (size, size)).copy_from(&-&dynamics.stiffness);
    matrix.view_mut((size, size), (size, size)).copy_from(&-&dynamics.damping);
    let meshes = 2 * N;
    let mut inputs = DMatrix::zeros(2 * size, meshes + 3);
    inputs.view_mut((size, 0), (size, meshes)).copy_from(&dynamics.mesh_gain);
    inputs.view_mut((size, meshes), (size, 3)).copy_from(&dynamics.torque_gain);
    let exponential::Flow { transition, input_integrals } = exponential::flow(&matrix, &inputs, step, 1);
    let response = &input_integrals[0];
    // Entries of the full state behind an in-phase entry: all planets, or one other coordinate if it exists.
    let full = |entry: usize| match entry % 3 {
        0 => (size * (entry / 3), N),
        other if N + other - 1 < size => (size * (entry / 3) + N + other - 1, 1),
        _ => (0, 0),
    };
    let mean = |matrix: &DMatrix<f64>, entry: usize, column: usize| {
        let (first, count) = full(entry);
        (first..first + count).map(|row| matrix[(row, column)]).sum::<f64>() / count.max(1) as f64
    };
    let real = T::from_f64;
    Flow {
        in_phase: array::from_fn(|row| {
            array::from_fn(|column| {
                let (first, count) = full(column);
                real((first..first + count).map(|column| mean(&transition, row, column)).sum())
            })
        }),
        missing: array::from_fn(|row| [0, N].map(|mesh| real(mean(response, row, mesh)))),
        torques: array::from_fn(|row| array::from_fn(|body| real(mean(response, row, meshes + body)))),
        // Between two planets: own effect less the effect of another planet.
        deviation: array::from_fn(|row| {
            array::from_fn(|column| {
                real(transition[(size * row, size * column)] - transition[(size * row, size * column + 1)])
            })
        }),
        missing_deviation: [0, size].map(|row| real(response[(row, 0)] - response[(row, 1)])),
        stiffness: MESH_KINDS.map(|kind| real(parameters.mesh(kind).mean_stiffness / scales.stiffness)),
        share: real(1.0 / N as f64),
    }
}

fn mesh<T: Real>(parameters: &JointParameters, scales: &Scales, kind: MeshKind, planet: usize) -> Mesh<T> {
    let family = parameters.mesh(kind);
    let phase = parameters.error_phase(kind, planet);
    let amplitude = family.transmission_error[planet] / scales.length;
    let stiffness = family.mean_stiffness / scales.stiffness;
    let mut ripple = [[T::ZERO; 2]; MAX_HARMONICS];
    for (harmonic, pair) in (1..=family.stiffness_wave.order()).zip(&mut ripple) {
        let (sine, cosine) = family.stiffness_wave.coefficients(harmonic);
        let (swing, ahead) = (stiffness * sine.hypot(cosine), cosine.atan2(sine));
        let phase = harmonic as f64 * parameters.stiffness_phase(kind, planet) + ahead;
        *pair = [T::from_f64(swing * phase.cos()), T::from_f64(swing * phase.sin())];
    }
    Mesh {
        half_backlash: T::from_f64(family.half_backlash[planet] / scales.length),
        error: [T::from_f64(amplitude * phase.cos()), T::from_f64(amplitude * phase.sin())],
        stiffness: T::from_f64(stiffness),
        ripple,
    }
}

impl<T: Real, const N: usize> Start<T, N> {
    /// Start from sun-planet deflections, gap and wind-up [m], their rates [m/s] and the rigid carrier's angle [2^-64 turns] and speed
    /// [rad/s], for a plant of `rate` steps a second.
    pub fn new(
        parameters: &JointParameters,
        rate: f64,
        position: &Coordinates<f64, N>,
        speed: &Coordinates<f64, N>,
        (carrier_place, carrier_speed): (u64, f64),
    ) -> Self {
        let scales = Scales::new(parameters);
        let over = |values: &Coordinates<f64, N>, unit: f64| Coordinates {
            planets: values.planets.map(|value| T::from_f64(value / unit)),
            gap: T::from_f64(values.gap / unit),
            wind_up: T::from_f64(values.wind_up / unit),
        };
        Self {
            position: over(position, scales.length),
            rate: over(speed, scales.length * scales.frequency),
            rigid_place: carrier_place,
            rigid_speed: (carrier_speed / (TAU * rate) * WHOLE) as i64,
        }
    }
}

impl<T: Real> TwoMass<T> {
    /// Joint as two masses with one gap. With a spring between carrier and link, everything geared to the motor is one mass and the link
    /// the other; without it, sun and planets are one mass (at rest under torque the planets yield with the sun), carrier and link the
    /// other. The spring is the series of all meshes and the compliance, with the damping ratio of the softer of both.
    pub fn new(parameters: &JointParameters, rate: f64, contact: Contact) -> Self {
        let scales = Scales::new(parameters);
        let masses = MovingMasses::new(parameters);
        let planets = parameters.geometry.planets as f64;
        let (sun_lever, lever) = (parameters.geometry.sun_base_radius, parameters.geometry.carrier_base_radius());
        let [sun, ring] = MESH_KINDS.map(|kind| parameters.mesh(kind));
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let meshes = 4.0 * planets / (1.0 / sun.mean_stiffness + 1.0 / ring.mean_stiffness);
        let all = masses.rigid(parameters.geometry.planets);
        let (motor, stiffness, damping_ratio) = match parameters.compliance {
            None => (4.0 * masses.sun + planets * masses.planet, meshes, sun.damping_ratio),
            Some(compliance) => {
                let shaft = compliance.stiffness / (lever * lever);
                let softer = if shaft < meshes { compliance.damping_ratio } else { sun.damping_ratio };
                (all - masses.link.unwrap_or(0.0), 1.0 / (1.0 / meshes + 1.0 / shaft), softer)
            }
        };
        let load = all - motor;
        let mobility = 1.0 / motor + 1.0 / load;
        let damping = 2.0 * damping_ratio * (stiffness / mobility).sqrt();
        let real = T::from_f64;
        let acceleration = scales.acceleration();
        Self {
            contact,
            step: real(scales.frequency / rate),
            half_backlash: real(0.5 * (least(&sun.half_backlash) + least(&ring.half_backlash)) / scales.length),
            stiffness: real(stiffness * mobility * scales.length / acceleration),
            damping: real(damping * mobility * scales.length * scales.frequency / acceleration),
            // Speed ratio of an impact: half a period of the damped spring.
            restitution: real((-core::f64::consts::PI * damping_ratio / (1.0 - damping_ratio.powi(2)).sqrt()).exp()),
            gains: [real(2.0 / (sun_lever * motor * acceleration)), real(1.0 / (lever * load * acceleration))],
            link_offset: real(-motor / all * scales.length / lever),
            force: real(acceleration / (mobility * 2.0 * planets)),
        }
    }
}

//! Computes the tables of the fixed step from parameters, except for the flow (`flow_tables`).

use core::array;
use core::f64::consts::TAU;

use crate::gears::design::dynamics::{Dynamics, MovingMasses};
use crate::gears::design::error::DesignError;
use crate::gears::design::flow_tables::WholeTicks;
use crate::gears::design::step_size::{Effort, StepSize, Substeps};
use crate::gears::design::validate::validate;
use crate::gears::design::{equivalent, flow_tables, verlet_tables};
use crate::gears::kinematics::Kinematics;
use crate::gears::mechanics::Mechanics;
use crate::gears::mesh_phases::MeshPhasing;
use crate::gears::scales::Scales;
use crate::gears::stiffness_series::StiffnessSeries;
use crate::gears::tables::{Excitation, MeshTable, Mobility, Rigid, Scheme, Spring, StageTable, Tables, UnitTable};
use crate::numbers::Real;
use parameters::{DeadZone, JointParameters, MAX_HARMONICS, MESH_KINDS, MeshKind};

/// Computes the tables of the method that a board runs.
///
/// ```
/// use model_core::gears::{Tables, design::{DesignError, design}};
///
/// let s1 = joint_file::read(joint_file::preset("s1").unwrap()).unwrap().parameters;
/// let tables: Tables<f32, 3> = design(&s1, 10_000)?;
/// assert_eq!(tables.tick_rate, 10_000);
/// assert!(tables.digest_is_good(), "what a board asks before it runs");
/// // A joint with another number of planets is refused, and so is a rate at which its teeth cannot be followed.
/// assert!(matches!(design::<f32, 4>(&s1, 10_000), Err(DesignError::WrongPlanetCount { wanted: 4, given: 3 })));
/// assert!(design::<f32, 3>(&s1, 100).is_err());
/// # Ok::<(), DesignError>(())
/// ```
pub fn design<T: Real, const N: usize>(
    parameters: &JointParameters,
    tick_rate: u32,
) -> Result<Tables<T, N>, DesignError> {
    design_scheme(parameters, tick_rate, Scheme::Realtime, Effort::Board)
}

/// Computes the tables of a given method and effort.
pub fn design_scheme<T: Real, const N: usize>(
    parameters: &JointParameters,
    tick_rate: u32,
    scheme: Scheme,
    effort: Effort,
) -> Result<Tables<T, N>, DesignError> {
    validate(parameters)?;
    let planets = parameters.geometry.planets;
    if planets != N {
        return Err(DesignError::WrongPlanetCount { wanted: N, given: planets });
    }
    if parameters.equivalent_gear().is_some() {
        if scheme != Scheme::Realtime {
            return Err(DesignError::OneSchemeOnly);
        }
        StepSize::new(parameters).corrected_substeps(tick_rate, effort)?;
        let units = units(parameters, &Scales::new(parameters), tick_rate);
        let mut tables = equivalent::tables(parameters, tick_rate, units, rigid(parameters, tick_rate));
        tables.digest = tables.numbers_digest();
        return Ok(tables);
    }
    let scales = Scales::new(parameters);
    let dynamics = Dynamics::new(parameters, &scales);
    let real = T::from_f64;
    let step_size = StepSize::new(parameters);
    let substeps = step_size.corrected_substeps(tick_rate, effort)?;
    let chosen = step_size.substeps(tick_rate, effort)?;
    let (verlet_substeps, held) = match chosen {
        Substeps::Verlet(substeps) => (substeps, WholeTicks::Light),
        Substeps::Corrected(_) => (0, WholeTicks::Held),
    };
    let whole_ticks = if step_size.takes_whole_ticks(chosen, effort) { held } else { WholeTicks::Never };
    let tick = scales.frequency / f64::from(tick_rate);
    let substep = tick / f64::from(substeps);
    let flow_step = match scheme {
        Scheme::PaperEtd1 => substep,
        Scheme::Realtime | Scheme::RungeKutta4 | Scheme::SemiImplicitEuler => tick,
    };
    let mut tables = Tables {
        digest: 0,
        tick_rate,
        scheme,
        substeps,
        half_substep_share: real(0.5 / f64::from(substeps)),
        substep: real(substep),
        planet_share: real(1.0 / N as f64),
        damping_law: parameters.damping_law,
        sharpness: match parameters.dead_zone {
            DeadZone::Sharp => T::ZERO,
            DeadZone::Tanh { sharpness } => real(sharpness),
        },
        units: units(parameters, &scales, tick_rate),
        rigid: rigid(parameters, tick_rate),
        mobility: mobility(&dynamics, 1.0, 1.0),
        excitation: excitation(parameters, tick_rate, tick),
        springs: MESH_KINDS.map(|kind| Spring {
            stiffness: real(parameters.mesh(kind).mean_stiffness / scales.stiffness),
            damping: real(scales.damping(parameters.damping_coefficient(kind))),
        }),
        meshes: MESH_KINDS.map(|kind| array::from_fn(|i| mesh(parameters, &scales, kind, i))),
        stage: StageTable {
            rate: real(1.0 / substep),
            square_sixth: real(substep * substep / 6.0),
            mobility: mobility(&dynamics, substep * substep / 6.0, 1.0 / substep),
            damping: MESH_KINDS.map(|kind| real(scales.damping(parameters.damping_coefficient(kind)) / substep)),
        },
        flow: flow_tables::flow(&dynamics, flow_step, substeps, whole_ticks),
        verlet: verlet_tables::verlet(parameters, &mobility(&dynamics, 1.0, 1.0), tick, verlet_substeps),
    };
    tables.digest = tables.numbers_digest();
    Ok(tables)
}

fn units<T: Real>(parameters: &JointParameters, scales: &Scales, tick_rate: u32) -> UnitTable<T> {
    let real = T::from_f64;
    let masses = MovingMasses::new(parameters);
    let (sun_lever, lever) = (parameters.geometry.sun_base_radius, parameters.geometry.carrier_base_radius());
    let load_on = |mass: f64| 1.0 / (lever * mass * scales.acceleration());
    // u_s = 2 q + offset from the definition of the rigid coordinate q = phi^T M u / phi^T M phi.
    let rigid = masses.rigid(parameters.geometry.planets);
    let link = masses.link.unwrap_or(0.0);
    let outer = parameters.geometry.planets as f64 * masses.planet - masses.carrier - link;
    let motor = [2.0 * masses.planet / rigid, -outer / rigid, 2.0 * link / rigid];
    // u_l = u_s / 2 - gap / 2 - wind-up.
    let output = [0.5 * motor[0], 0.5 * (motor[1] - 1.0), 0.5 * motor[2] - 1.0];
    UnitTable {
        drive: real(1.0 / (sun_lever * masses.sun * scales.acceleration())),
        load_on_carrier: real(if masses.link.is_some() { 0.0 } else { load_on(masses.carrier) }),
        load_on_link: real(masses.link.map_or(0.0, load_on)),
        length: real(scales.length),
        carrier_speed: real(TAU * f64::from(tick_rate) / libm::ldexp(1.0, 64)),
        motor_offset: motor.map(|gain| real(gain * scales.length / sun_lever)),
        link_offset: output.map(|gain| real(gain * scales.length / lever)),
    }
}

fn rigid<T: Real>(parameters: &JointParameters, tick_rate: u32) -> Rigid<T> {
    let mass = MovingMasses::new(parameters).rigid(parameters.geometry.planets);
    let lever = parameters.geometry.carrier_base_radius();
    let rate = f64::from(tick_rate);
    // Speed change per tick, in 2^-64 turns a tick, per unit of acceleration of q [m/s^2].
    let unit = libm::ldexp(1.0, 64) / (TAU * lever * rate * rate);
    Rigid {
        drive: T::from_f64(unit * 2.0 / (parameters.geometry.sun_base_radius * mass)),
        load: T::from_f64(unit / (lever * mass)),
    }
}

/// Returns the mobilities times `scale` and the damping times `rate`.
fn mobility<T: Real>(dynamics: &Dynamics, scale: f64, rate: f64) -> Mobility<T> {
    let real = T::from_f64;
    let mobilities = &dynamics.mobilities;
    let carrier = dynamics.planets + 1;
    let (stiffness, damping) = dynamics.wind_up.unwrap_or((0.0, 0.0));
    Mobility {
        sun: real(scale * mobilities[0]),
        planet: real(scale * mobilities[1]),
        carrier: real(scale * mobilities[carrier]),
        link: real(scale * mobilities.get(carrier + 1).copied().unwrap_or(0.0)),
        wind_up: if dynamics.wind_up.is_some() { T::ONE } else { T::ZERO },
        wind_up_stiffness: real(stiffness),
        wind_up_damping: real(rate * damping),
    }
}

fn excitation<T: Real>(parameters: &JointParameters, tick_rate: u32, tick: f64) -> Excitation<T> {
    let real = T::from_f64;
    let unit = libm::ldexp(1.0, 32);
    let (periods, periods_per_turn) = match parameters.excitation {
        parameters::Excitation::Time { mesh_frequency } => (mesh_frequency / (TAU * f64::from(tick_rate)), 0),
        parameters::Excitation::Angle => (0.0, parameters.geometry.ring_teeth),
    };
    let order = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.order());
    Excitation {
        phase_step: ((periods - libm::floor(periods)) * libm::ldexp(1.0, 64)) as u64,
        phase_advance: real(periods * unit),
        periods_per_turn,
        rate: real(TAU / (unit * tick)),
        harmonics: order[0].max(order[1]) as u32,
    }
}

fn mesh<T: Real>(parameters: &JointParameters, scales: &Scales, kind: MeshKind, planet: usize) -> MeshTable<T> {
    let real = T::from_f64;
    let mesh = parameters.mesh(kind);
    let (error_sine, error_cosine) = libm::sincos(parameters.error_phase(kind, planet));
    let amplitude = mesh.transmission_error[planet] / scales.length;
    let mean = mesh.mean_stiffness / scales.stiffness;
    let mut ripple = [[T::ZERO; 2]; MAX_HARMONICS];
    for (index, pair) in ripple.iter_mut().enumerate().take(mesh.stiffness_wave.order()) {
        let harmonic = index + 1;
        let (a, b) = mesh.stiffness_wave.coefficients(harmonic);
        let (sine, cosine) = libm::sincos(harmonic as f64 * parameters.stiffness_phase(kind, planet));
        *pair = [real(mean * (a * cosine - b * sine)), real(mean * (a * sine + b * cosine))];
    }
    MeshTable {
        half_backlash: real(mesh.half_backlash[planet] / scales.length),
        error: [real(amplitude * error_cosine), real(amplitude * error_sine)],
        ripple,
    }
}

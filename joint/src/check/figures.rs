//! What follows from a joint file, as figures in SI with their units in their names: the JSON of `joint check`, and what
//! its text is laid out from. Only closed forms and eigenvalues; the motion is left to `sim` and `hil`.

use std::f64::consts::TAU;

use joints::Severity;
use model_core::design::modes::natural_frequencies;
use model_core::joint::{JointParameters, PerPlanet};
use model_core::mesh::{DampingLaw, MESH_KINDS, MeshKind};
use model_core::scales::Scales;
use serde::Serialize;

use super::source::Loaded;
use super::step::{lowest_rate, step};
use crate::failure::{Failure, Outcome};

/// Says which fields there are; rises when one changes its meaning or goes.
const SCHEMA: &str = "joint-check/1";

/// Everything that `joint check` says of a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// `joint-check/1`.
    pub schema: String,
    /// Path or preset.
    pub file: String,
    /// The joint's own name.
    pub name: String,
    /// From the file; may be empty.
    pub description: String,
    /// Teeth, radii, ratio.
    pub geometry: GeometryFigures,
    /// Masses along the line of action.
    pub equivalent_masses: Masses,
    /// omega_n and natural frequencies.
    pub frequencies: Frequencies,
    /// Sun-planet, then ring-planet.
    pub meshes: [MeshFigures; 2],
    /// `contact` or `paper`.
    pub damping_law: &'static str,
    /// What the output does under load and when it is turned by hand.
    pub output: Output,
    /// The fixed step at the wanted rate.
    pub fixed_step: FixedStep,
    /// How many numbers the file states, and how many of them it calls assumed.
    pub numbers: Numbers,
    /// What is odd but can be used.
    pub warnings: Vec<Warning>,
}

/// Teeth, radii, ratio.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs, reason = "names and units say it")]
pub struct GeometryFigures {
    pub planets: usize,
    pub sun_teeth: u32,
    pub planet_teeth: u32,
    pub ring_teeth: u32,
    pub working_pressure_angle_deg: f64,
    pub sun_base_radius_m: f64,
    pub planet_base_radius_m: f64,
    pub carrier_radius_m: f64,
    /// r_c cos(alpha).
    pub carrier_base_radius_m: f64,
    /// 2 r_c cos(alpha) / r_bs.
    pub ratio_by_radii: f64,
    /// 1 + Zr/Zs.
    pub ratio_by_teeth: f64,
}

/// Masses along the line of action, I / r^2.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Masses {
    /// The sun's own.
    pub sun_kg: f64,
    /// With the motor rotor.
    pub sun_with_rotor_kg: f64,
    /// Of one planet.
    pub planet_kg: f64,
    /// M_c: the carrier with its planets.
    pub carrier_with_planets_kg: f64,
    /// The link, over (r_c cos(alpha))^2; 0 without a link.
    pub link_kg: f64,
}

/// omega_n and natural frequencies, undamped, all meshes in contact at mean stiffness.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct Frequencies {
    /// Eq. 18.
    pub omega_n_rad_per_s: f64,
    /// omega_n / 2 pi.
    pub omega_n_Hz: f64,
    /// Gears alone, as the paper has them; the rigid body's zero left out.
    pub gears_alone_Hz: Vec<f64>,
    /// With rotor, link and compliance; the rigid body's zero left out.
    pub whole_joint_Hz: Vec<f64>,
}

/// One family of meshes. Lists hold one value for each planet.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "N is written N")]
pub struct MeshFigures {
    /// `sun_planet` or `ring_planet`.
    pub kind: &'static str,
    /// b.
    pub half_backlash_m: Vec<f64>,
    /// Phase of the stiffness ripple, in mesh periods from 0 to 1.
    pub stiffness_phase_periods: Vec<f64>,
    /// Phase of the transmission error, likewise.
    pub error_phase_periods: Vec<f64>,
    /// K_m.
    pub mean_stiffness_N_per_m: f64,
    /// C of eqs 9 and 10.
    pub damping_N_s_per_m: f64,
    /// How far the teeth give under the rated torque, beyond b.
    pub deflection_at_rated_torque_m: f64,
}

/// Seen from the link.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "N is written N")]
pub struct Output {
    /// From the file.
    pub rated_torque_N_m: f64,
    /// At the sun, in balance with the rated torque by the ratio of radii.
    pub balancing_drive_torque_N_m: f64,
    /// Force of one mesh at rated torque, shared alike.
    pub mesh_force_N: f64,
    /// Span of the gap coordinate u_s - 2 u_c while every mesh is free: 4 b.
    pub gap_m: f64,
    /// With the sun held, the link turns this far without resistance.
    pub lost_motion_rad: f64,
    /// The same in minutes of arc.
    pub lost_motion_arcmin: f64,
    /// With the link held, the sun turns this far.
    pub lost_motion_at_sun_rad: f64,
    /// Wind-up of the teeth at rated torque, beyond the lost motion.
    pub wind_up_of_teeth_rad: f64,
    /// Wind-up between carrier and link at rated torque.
    pub wind_up_of_compliance_rad: f64,
    /// Both together.
    pub wind_up_rad: f64,
    /// Both together in minutes of arc.
    pub wind_up_arcmin: f64,
}

/// The fixed step at the wanted rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct FixedStep {
    /// Asked for.
    pub rate_Hz: u32,
    /// Below it no step is stable.
    pub lowest_rate_Hz: u32,
    /// 1 / lowest rate.
    pub longest_step_s: f64,
    /// Parts of a tick while contacts change.
    pub substeps: u32,
    /// Phase of the fastest mode in one part.
    pub fastest_mode_phase_rad: f64,
    /// Flash that the f32 tables take.
    pub table_bytes: usize,
    /// The board's digest of them, in hexadecimal.
    pub digest: String,
}

/// How well founded the file is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Numbers {
    /// Numbers in the file.
    pub stated: usize,
    /// Those whose comment begins with "assumed".
    pub assumed: usize,
    /// Those without a comment.
    pub without_source: usize,
}

/// What is odd but can be used.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Warning {
    /// Line of the file, from 1.
    pub line: usize,
    /// What is odd.
    pub message: String,
    /// How to mend it.
    pub help: String,
}

/// Radians to minutes of arc.
fn arcmin(angle: f64) -> f64 {
    angle.to_degrees() * 60.0
}

/// The figures of a joint at a step rate [Hz].
pub fn figures(loaded: &Loaded, rate: u32) -> Outcome<Figures> {
    let parameters = &loaded.file.parameters;
    let figures = Figures {
        schema: SCHEMA.to_owned(),
        file: loaded.name.clone(),
        name: parameters.name.to_string(),
        description: loaded.file.description.clone(),
        geometry: geometry(parameters),
        equivalent_masses: masses(parameters),
        frequencies: frequencies(parameters),
        meshes: MESH_KINDS.map(|kind| mesh(parameters, kind)),
        damping_law: match parameters.damping_law {
            DampingLaw::Contact => "contact",
            DampingLaw::Paper => "paper",
        },
        output: output(parameters),
        fixed_step: fixed_step(parameters, rate)?,
        numbers: numbers(loaded),
        warnings: warnings(loaded),
    };
    // Bounds of the reader keep every figure finite; if one is not, it must not be printed.
    let json = serde_json::to_value(&figures).map_err(|error| Failure::new(error.to_string()))?;
    match first_null(&json, "") {
        Some(path) => Err(Failure::new(format!("{} cannot be used: {path} is not a finite number", loaded.name))
            .with_help("look for a value that is orders of magnitude off")),
        None => Ok(figures),
    }
}

/// JSON has no NaN and no infinity: both become null.
fn first_null(value: &serde_json::Value, path: &str) -> Option<String> {
    match value {
        serde_json::Value::Null => Some(path.trim_start_matches('.').to_owned()),
        serde_json::Value::Array(items) => items.iter().find_map(|item| first_null(item, path)),
        serde_json::Value::Object(fields) => {
            fields.iter().find_map(|(key, field)| first_null(field, &format!("{path}.{key}")))
        }
        _ => None,
    }
}

fn geometry(parameters: &JointParameters) -> GeometryFigures {
    let geometry = &parameters.geometry;
    GeometryFigures {
        planets: geometry.planets,
        sun_teeth: geometry.sun_teeth,
        planet_teeth: geometry.planet_teeth,
        ring_teeth: geometry.ring_teeth,
        working_pressure_angle_deg: geometry.working_pressure_angle.to_degrees(),
        sun_base_radius_m: geometry.sun_base_radius,
        planet_base_radius_m: geometry.planet_base_radius,
        carrier_radius_m: geometry.carrier_radius,
        carrier_base_radius_m: geometry.carrier_base_radius(),
        ratio_by_radii: geometry.ratio_by_radii(),
        ratio_by_teeth: geometry.ratio_by_teeth(),
    }
}

fn masses(parameters: &JointParameters) -> Masses {
    let bodies = &parameters.bodies;
    Masses {
        sun_kg: bodies.sun_equivalent_mass,
        sun_with_rotor_kg: bodies.sun_equivalent_mass + parameters.rotor_equivalent_mass(),
        planet_kg: bodies.planet_equivalent_mass,
        carrier_with_planets_kg: parameters.carrier_equivalent_mass(),
        link_kg: parameters.link_equivalent_mass(),
    }
}

fn frequencies(parameters: &JointParameters) -> Frequencies {
    let gears_alone = JointParameters { rotor_inertia: 0.0, link_inertia: 0.0, compliance: None, ..parameters.clone() };
    let in_hertz = |parameters: &JointParameters| {
        natural_frequencies(parameters).into_iter().skip(1).map(|frequency| frequency / TAU).collect()
    };
    let omega_n = Scales::new(parameters).frequency;
    Frequencies {
        omega_n_rad_per_s: omega_n,
        omega_n_Hz: omega_n / TAU,
        gears_alone_Hz: in_hertz(&gears_alone),
        whole_joint_Hz: in_hertz(parameters),
    }
}

/// Force of one mesh at rated torque: each planet hands 2 F to the carrier [N].
fn mesh_force(parameters: &JointParameters) -> f64 {
    let geometry = &parameters.geometry;
    parameters.rated_output_torque / (2.0 * geometry.planets as f64 * geometry.carrier_base_radius())
}

fn mesh(parameters: &JointParameters, kind: MeshKind) -> MeshFigures {
    let mesh = parameters.mesh(kind);
    let planets = 0..parameters.geometry.planets;
    // The sum with 0.0 takes the sign off a zero.
    let periods = |phase: f64| (phase / TAU).rem_euclid(1.0) + 0.0;
    MeshFigures {
        kind: match kind {
            MeshKind::SunPlanet => "sun_planet",
            MeshKind::RingPlanet => "ring_planet",
        },
        half_backlash_m: mesh.half_backlash.to_vec(),
        stiffness_phase_periods: planets.clone().map(|i| periods(parameters.stiffness_phase(kind, i))).collect(),
        error_phase_periods: planets.map(|i| periods(parameters.error_phase(kind, i))).collect(),
        mean_stiffness_N_per_m: mesh.mean_stiffness,
        damping_N_s_per_m: parameters.damping_coefficient(kind),
        deflection_at_rated_torque_m: mesh_force(parameters) / mesh.mean_stiffness,
    }
}

/// Span of u_s - 2 u_c over which the tightest planet still carries nothing: twice the sum of its half-backlashes.
fn gap(sun_planet: &PerPlanet, ring_planet: &PerPlanet) -> f64 {
    2.0 * sun_planet.iter().zip(ring_planet).map(|(sun, ring)| sun + ring).fold(f64::INFINITY, f64::min)
}

fn output(parameters: &JointParameters) -> Output {
    let torque = parameters.rated_output_torque;
    let lever = parameters.geometry.carrier_base_radius();
    let force = mesh_force(parameters);
    let gap = gap(&parameters.sun_planet.half_backlash, &parameters.ring_planet.half_backlash);
    let give = force / parameters.sun_planet.mean_stiffness + force / parameters.ring_planet.mean_stiffness;
    let lost_motion = gap / (2.0 * lever);
    let of_teeth = give / (2.0 * lever);
    let of_compliance = parameters.compliance.map_or(0.0, |compliance| torque / compliance.stiffness);
    Output {
        rated_torque_N_m: torque,
        balancing_drive_torque_N_m: torque / parameters.geometry.ratio_by_radii(),
        mesh_force_N: force,
        gap_m: gap,
        lost_motion_rad: lost_motion,
        lost_motion_arcmin: arcmin(lost_motion),
        lost_motion_at_sun_rad: gap / parameters.geometry.sun_base_radius,
        wind_up_of_teeth_rad: of_teeth,
        wind_up_of_compliance_rad: of_compliance,
        wind_up_rad: of_teeth + of_compliance,
        wind_up_arcmin: arcmin(of_teeth + of_compliance),
    }
}

fn fixed_step(parameters: &JointParameters, rate: u32) -> Outcome<FixedStep> {
    let failed = |error: model_core::design::DesignError| {
        Failure::new(format!("no fixed step for {}: {error}", parameters.name))
            .with_help("`--rate` sets the steps a second")
    };
    let lowest = lowest_rate(parameters).map_err(failed)?;
    let step = step(parameters, rate).map_err(failed)?;
    let fastest = natural_frequencies(parameters).last().copied().unwrap_or(0.0);
    Ok(FixedStep {
        rate_Hz: rate,
        lowest_rate_Hz: lowest,
        longest_step_s: 1.0 / f64::from(lowest),
        substeps: step.substeps,
        fastest_mode_phase_rad: fastest / (f64::from(rate) * f64::from(step.substeps)),
        table_bytes: step.table_bytes,
        digest: format!("{:016x}", step.digest),
    })
}

fn numbers(loaded: &Loaded) -> Numbers {
    let sources = &loaded.file.sources;
    let assumed = |remark: &String| remark.to_lowercase().starts_with("assumed");
    Numbers {
        stated: sources.len(),
        assumed: sources.iter().filter(|source| source.remark.as_ref().is_some_and(assumed)).count(),
        without_source: sources.iter().filter(|source| source.remark.is_none()).count(),
    }
}

fn warnings(loaded: &Loaded) -> Vec<Warning> {
    let warnings = loaded.file.warnings.iter().filter(|warning| warning.severity == Severity::Warning);
    warnings
        .map(|warning| Warning {
            line: loaded.text[..warning.span.start].matches('\n').count() + 1,
            message: warning.message.clone(),
            help: warning.help.clone(),
        })
        .collect()
}

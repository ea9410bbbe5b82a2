//! Figures of a joint file: closed forms, eigenvalues and the design of the fixed step.

use std::f64::consts::TAU;

use joint_file::{Severity, sheet};
use model_core::gears::design::StepSize;
use model_core::gears::design::modes::natural_frequencies;
use model_core::gears::{Kinematics, Mechanics, MeshPhasing, SELF_LOCKING, Scales};
use parameters::{DampingLaw, EquivalentGear, JointParameters, MESH_KINDS, MeshKind};

use super::step::step;
use super::summary::{
    CheckSummary, EquivalentFigures, FixedStep, Frequencies, GeometryFigures, Masses, MeshFigures, Numbers, Output,
    SCHEMA, Warning,
};
use crate::bandwidth::Bandwidth;
use crate::verdicts::verdicts;
use board::device::board::Board;
use board::device::tick_time::RateCheck;
use joint_file::named::Loaded;
use link::messages::Role;
use report::failure::{Failure, Outcome};

/// Radians to minutes of arc.
pub(super) fn arcmin(angle: f64) -> f64 {
    angle.to_degrees() * 60.0
}

/// Figures of a joint on a board at a step rate [Hz]; with errors and verdicts if a largest acceptable error is given.
pub fn summary(loaded: &Loaded, board: &Board, rate: u32, wanted: Option<f64>) -> Outcome<CheckSummary> {
    let parameters = &loaded.file.parameters;
    let with_teeth = parameters.equivalent_gear().is_none();
    let summary = CheckSummary {
        schema: SCHEMA.to_owned(),
        file: loaded.name.clone(),
        name: parameters.name.to_string(),
        description: loaded.file.description.clone(),
        equivalent_gear: parameters.equivalent_gear().map(|gear| equivalent(parameters, &gear)),
        geometry: with_teeth.then(|| geometry(parameters)),
        equivalent_masses: with_teeth.then(|| masses(parameters)),
        frequencies: frequencies(parameters),
        meshes: MESH_KINDS.into_iter().filter(|_| with_teeth).map(|kind| mesh(parameters, kind)).collect(),
        damping_law: match parameters.damping_law {
            DampingLaw::Contact => "contact",
            DampingLaw::Paper => "paper",
        },
        output: output(parameters, loaded.file.surroundings.efficiency),
        bandwidth: Bandwidth::for_joint(&loaded.file.parameters, &loaded.file.surroundings),
        fixed_step: fixed_step(parameters, board, rate, wanted)?,
        numbers: numbers(loaded),
        warnings: warnings(loaded),
    };
    // The reader's bounds keep every figure finite; any other figure must not be printed.
    let json = serde_json::to_value(&summary).map_err(|error| Failure::new(error.to_string()))?;
    match first_null(&json, "") {
        Some(path) => Err(Failure::new(format!("{} cannot be used: {path} is not a finite number", loaded.name))
            .with_help("look for a value that is orders of magnitude off")),
        None => Ok(summary),
    }
}

/// Path of the first null: JSON has no NaN and no infinity, and writes both as null.
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

fn equivalent(parameters: &JointParameters, gear: &EquivalentGear) -> EquivalentFigures {
    let [motor_turns, link_turns] = gear.ratio;
    let ratio = parameters.geometry.ratio_by_teeth();
    let motor = parameters.rotor_inertia + gear.inertia_at_input;
    let series = parameters.inertia_in_series();
    EquivalentFigures {
        motor_turns,
        link_turns,
        ratio,
        stiffness_N_m_per_rad: gear.stiffness,
        damping_ratio: gear.damping_ratio,
        damping_N_m_s_per_rad: 2.0 * gear.damping_ratio * (gear.stiffness * series).sqrt(),
        gear_inertia_at_input_kg_m2: gear.inertia_at_input,
        motor_inertia_kg_m2: motor,
        motor_inertia_at_link_kg_m2: motor * ratio * ratio,
        link_inertia_kg_m2: parameters.link_inertia,
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
        // An equivalent gear alone, without rotor and link, has no oscillation.
        gears_alone_Hz: if parameters.equivalent_gear().is_some() { Vec::new() } else { in_hertz(&gears_alone) },
        whole_joint_Hz: in_hertz(parameters),
    }
}

/// Force of one mesh at rated torque [N].
fn mesh_force(parameters: &JointParameters) -> f64 {
    parameters.rated_output_torque * sheet::force_per_torque(&parameters.geometry)
}

fn mesh(parameters: &JointParameters, kind: MeshKind) -> MeshFigures {
    let mesh = parameters.mesh(kind);
    let planets = 0..parameters.geometry.planets;
    // Adding 0.0 removes the sign of a negative zero.
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

fn output(parameters: &JointParameters, efficiency: f64) -> Output {
    let torque = parameters.rated_output_torque;
    let (force, gap) = (mesh_force(parameters), sheet::gap(parameters));
    let lost_motion = sheet::lost_motion(parameters);
    let stiffness = MESH_KINDS.map(|kind| parameters.mesh(kind).mean_stiffness);
    let of_teeth = torque * sheet::teeth_compliance(&parameters.geometry, stiffness);
    let of_compliance = parameters.compliance.map_or(0.0, |compliance| torque / compliance.stiffness);
    Output {
        rated_torque_N_m: torque,
        balancing_drive_torque_N_m: torque / parameters.geometry.ratio_by_radii(),
        mesh_force_N: parameters.equivalent_gear().is_none().then_some(force),
        gap_m: gap,
        lost_motion_rad: lost_motion,
        lost_motion_arcmin: arcmin(lost_motion),
        lost_motion_at_sun_rad: gap / parameters.geometry.sun_base_radius,
        wind_up_of_teeth_rad: of_teeth,
        wind_up_of_compliance_rad: of_compliance,
        wind_up_rad: of_teeth + of_compliance,
        wind_up_arcmin: arcmin(of_teeth + of_compliance),
        self_locking: efficiency < SELF_LOCKING,
    }
}

fn fixed_step(parameters: &JointParameters, board: &Board, rate: u32, wanted: Option<f64>) -> Outcome<FixedStep> {
    let failed = |error: model_core::gears::design::DesignError| {
        Failure::new(format!("no fixed step for {}: {error}", parameters.name))
            .with_help("`--rate` sets the steps a second")
    };
    let step = step(parameters, board.processor(), rate).map_err(failed)?;
    let step_size = StepSize::new(parameters);
    let on_board = RateCheck::new(parameters, board, Role::Plant);
    let substeps = on_board.substeps(rate).map_err(failed)?;
    let (lowest, recommended) = (on_board.lowest_rate(), step_size.recommended_rate());
    let verdicts = wanted.map(|wanted| verdicts(parameters, board, Role::Plant, rate, wanted)).transpose()?;
    Ok(FixedStep {
        board: board.name().to_owned(),
        rate_Hz: rate,
        lowest_rate_Hz: lowest,
        longest_step_s: 1.0 / f64::from(lowest),
        recommended_rate_Hz: recommended,
        recommended_step_s: 1.0 / f64::from(recommended),
        method: substeps.method(),
        substeps: substeps.count(),
        fastest_mode_phase_rad: step_size.phase(rate, substeps.count()),
        table_bytes: step.table_bytes,
        digest: format!("{:016x}", step.digest),
        verdicts,
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

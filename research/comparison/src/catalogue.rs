//! The cases of the comparison: named cases for all methods, and similar ones for any joint.

use std::f64::consts::TAU;

use model_core::gears::{Kinematics, MeshPhasing, Scales};
use parameters::{Excitation, JointParameters, MeshKind, MeshPhases, PerPlanet};
use reference::joint::{RelativeState, Start};
use reference::scenarios::{
    CASE_A_OMEGA, CASE_Q_OMEGA, Scenario, TorqueSegment, case, case_r, motions, paper_natural_frequency, random_joint,
    same,
};

use crate::case::Case;

/// Dimensionless time from which cases with a prescribed phase are evaluated: transients of the start have decayed.
const SETTLED: f64 = 100.0;
/// Dimensionless length of cases with a prescribed phase.
const LENGTH: f64 = 300.0;
/// Sample rate of cases at the paper's joint: two samples per unit of dimensionless time [Hz].
const SAMPLE_RATE: u32 = 40_000;

/// All cases.
pub fn cases() -> Vec<Case> {
    let settled = SETTLED / paper_natural_frequency();
    let paper =
        |key: &str, title: &str, scenario: Scenario| Case::from_scenario(key, title, scenario, SAMPLE_RATE, settled);
    let mut all = vec![
        paper("A", "meshes part and hit eleven times a mesh period", case("A", CASE_A_OMEGA)),
        paper("Q", "contact holds", case("Q", CASE_Q_OMEGA)),
        Case::from_robot_joint("R", "what a robot joint does", case_r::case_r()),
        paper("B", "both flanks hit", both_flanks()),
        paper("F", "five planets, meshes part and hit", five_planets()),
    ];
    let reversal = motions().into_iter().find(|scenario| scenario.name == "L1 contact, reversal through the gap");
    all.extend(reversal.map(|scenario| {
        Case::from_scenario("L", "a large joint reversed through its gap, phase by angle", scenario, SAMPLE_RATE, 0.0)
    }));
    all
}

/// Case of a joint from a file: the motion of a robot joint if its angle determines the mesh phase; steady running under half the rated
/// torque if the phase is prescribed.
pub fn for_joint(joint: &JointParameters) -> Case {
    let key = joint.name.as_str();
    if joint.excitation == Excitation::Angle {
        return Case::from_robot_joint(key, "what a robot joint does", case_r::on(joint.clone()));
    }
    let geometry = &joint.geometry;
    let load = 0.5 * joint.rated_output_torque;
    let drive = load / geometry.ratio_by_radii();
    let force = drive / (geometry.planets as f64 * geometry.sun_base_radius);
    let deflections = [MeshKind::SunPlanet, MeshKind::RingPlanet].map(|kind| {
        let mesh = joint.mesh(kind);
        mesh.half_backlash.iter().copied().fold(0.0, f64::max) + force / mesh.mean_stiffness
    });
    let wind_up =
        joint.compliance.map_or(0.0, |compliance| load / compliance.stiffness * geometry.carrier_base_radius());
    let start = RelativeState {
        sun_planet: same(geometry.planets, deflections[0]),
        gap: deflections[0] + deflections[1],
        wind_up,
        ..RelativeState::centred(geometry.planets)
    };
    let frequency = Scales::new(joint).frequency;
    // Tick length near the paper's, on a grid of whole kilohertz.
    let tick_rate = 1_000 * (frequency / 1_000.0).ceil().max(1.0) as u32;
    Case {
        key: key.into(),
        title: "steady running under half the rated torque".into(),
        joint: joint.clone(),
        start: Start::Relative(start),
        torques: vec![TorqueSegment { from_tick: 0, drive_torque: drive, load_torque: load }],
        tick_rate,
        ticks: (LENGTH / frequency * f64::from(tick_rate)).ceil() as u64,
        sample_rate: 2 * tick_rate,
        counts_from: SETTLED / frequency,
        parts: vec![0],
        restarts: Vec::new(),
        measure: crate::case::Measure::Deflections,
    }
}

/// Motion of a robot joint, a fifth as long, on the random joint of a seed; `None` for an equivalent gear, which has no meshes.
pub fn for_seed(seed: u64) -> Option<Case> {
    let joint = random_joint(seed);
    let (key, has_teeth) = (joint.name.to_string(), joint.equivalent_gear().is_none());
    has_teeth.then(|| Case::from_robot_joint(&key, "what a robot joint does, in brief", case_r::brief(joint)))
}

/// Case A with a narrow gap and a small torque, at a frequency at which the motion is not chaotic.
fn both_flanks() -> Scenario {
    loaded(case("B", BOTH_FLANKS.0), BOTH_FLANKS.1, BOTH_FLANKS.2)
}

/// Frequency omega/omega_n, half-backlash [m] and mean deflection [m].
const BOTH_FLANKS: (f64, f64, f64) = (0.6, 10e-6, 3e-6);

/// Case A's joint with five planets: 25/35/95 teeth, planets a fifth of a mesh period apart.
fn five_planets() -> Scenario {
    let mut scenario = case("F", FIVE_OMEGA);
    let joint = &mut scenario.joint;
    let geometry = &mut joint.geometry;
    let module = 2.0 * geometry.sun_base_radius / 27.0;
    (geometry.planets, geometry.sun_teeth, geometry.planet_teeth, geometry.ring_teeth) = (5, 25, 35, 95);
    geometry.sun_base_radius = 0.5 * module * 25.0;
    geometry.planet_base_radius = 0.5 * module * 35.0;
    geometry.carrier_radius = 0.5 * module * 60.0 / geometry.working_pressure_angle.cos();
    let fifths = |offset: f64| -> PerPlanet { (0..5).map(|planet| TAU * f64::from(planet) / 5.0 + offset).collect() };
    for (mesh, stiffness, error) in [(&mut joint.sun_planet, 0.4, 0.0), (&mut joint.ring_planet, 2.3, 0.7)] {
        mesh.half_backlash = same(5, 60e-6);
        mesh.transmission_error = same(5, 10e-6);
        mesh.phases = MeshPhases::Given { stiffness: fifths(stiffness), error: fifths(error) };
    }
    loaded(scenario, 60e-6, 15e-6)
}

/// Frequency omega/omega_n of case F.
const FIVE_OMEGA: f64 = 0.8;

/// Scenario with another half-backlash, balanced under the torque of a mean deflection [m], starting from rest under this torque without
/// errors.
fn loaded(mut scenario: Scenario, half_backlash: f64, mean_deflection: f64) -> Scenario {
    let joint = &mut scenario.joint;
    let planets = joint.geometry.planets;
    joint.sun_planet.half_backlash = same(planets, half_backlash);
    joint.ring_planet.half_backlash = same(planets, half_backlash);
    let drive = planets as f64 * joint.sun_planet.mean_stiffness * mean_deflection * joint.geometry.sun_base_radius;
    for segment in &mut scenario.torques {
        segment.drive_torque = drive;
        segment.load_torque = drive * joint.geometry.ratio_by_radii();
    }
    let Excitation::Time { mesh_frequency } = joint.excitation else { return scenario };
    let rest = half_backlash + mean_deflection;
    let error = |planet: usize| {
        let (sine, cosine) = joint.error_phase(MeshKind::SunPlanet, planet).sin_cos();
        [sine, mesh_frequency * cosine].map(|factor| joint.sun_planet.transmission_error[planet] * factor)
    };
    scenario.start = Start::Relative(RelativeState {
        sun_planet: (0..planets).map(|planet| rest - error(planet)[0]).collect(),
        sun_planet_rate: (0..planets).map(|planet| -error(planet)[1]).collect(),
        gap: 2.0 * rest,
        ..RelativeState::centred(planets)
    });
    scenario
}

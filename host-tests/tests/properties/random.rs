//! Random joints about the size of L1, and random motions of them.

use std::f64::consts::TAU;
use std::ops::Range;

use parameters::{Compliance, DampingLaw, Excitation, JointParameters, Mesh, MeshPhases, PerPlanet, StiffnessWave};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use reference::joint::RelativeState;
use reference::scenarios::{Scenario, TorqueSegment, l1, same};

/// Tick rate of every scenario [Hz].
pub const TICK_RATE: u32 = 20_000;

/// Log-uniform number from a tenth to ten times a value.
fn about(value: f64) -> impl Strategy<Value = f64> {
    (-1.0..1.0_f64).prop_map(move |power| value * 10.0_f64.powf(power))
}

fn per_planet(planets: usize, range: Range<f64>) -> impl Strategy<Value = PerPlanet> {
    prop::collection::vec(range, planets).prop_map(|values| values.into_iter().collect())
}

fn wave() -> impl Strategy<Value = StiffnessWave> {
    prop_oneof![
        (0.0..0.5).prop_map(|stiffness_ratio| StiffnessWave::Harmonic { stiffness_ratio }),
        (0.0..0.15, 1.05..1.95, 1..8_usize).prop_map(|(stiffness_ratio, contact_ratio, order)| {
            StiffnessWave::Rectangular { stiffness_ratio, contact_ratio, order }
        }),
    ]
}

fn mesh(planets: usize) -> impl Strategy<Value = Mesh> {
    let phases = prop_oneof![
        (per_planet(planets, 0.0..TAU), per_planet(planets, 0.0..TAU))
            .prop_map(|(stiffness, error)| MeshPhases::Given { stiffness, error }),
        (0.0..TAU, 0.0..TAU).prop_map(|(stiffness, error)| MeshPhases::FromTeeth { stiffness, error }),
    ];
    let half_backlash = prop_oneof![Just(same(planets, 0.0)), per_planet(planets, 0.0..120e-6)];
    (about(1e8), wave(), 0.0..0.3, half_backlash, per_planet(planets, -20e-6..20e-6), phases).prop_map(
        |(mean_stiffness, stiffness_wave, damping_ratio, half_backlash, transmission_error, phases)| Mesh {
            mean_stiffness,
            stiffness_wave,
            damping_ratio,
            half_backlash,
            transmission_error,
            phases,
        },
    )
}

/// Joints about the size of L1.
pub fn joint() -> impl Strategy<Value = JointParameters> {
    let meshes = (3..=5_usize).prop_flat_map(|planets| (mesh(planets), mesh(planets)));
    let masses = (about(0.4), about(0.6), about(6.0), about(2e-3), about(0.6));
    let compliance = prop::option::of((about(1e4), 0.0..0.3));
    let excitation = prop_oneof![
        Just(Excitation::Angle),
        (0.0..40e3).prop_map(|mesh_frequency| Excitation::Time { mesh_frequency }),
    ];
    (meshes, masses, compliance, excitation, any::<bool>(), 20..40_u32).prop_map(
        |((sun_planet, ring_planet), (sun, planet, carrier, rotor, link), compliance, excitation, contact, teeth)| {
            let mut joint = l1();
            joint.geometry.planets = sun_planet.half_backlash.len();
            joint.geometry.sun_teeth = teeth;
            joint.geometry.ring_teeth = 3 * teeth + teeth % 7;
            joint.bodies.sun_equivalent_mass = sun;
            joint.bodies.planet_equivalent_mass = planet;
            joint.bodies.carrier_inertia_over_radius_squared = carrier;
            (joint.rotor_inertia, joint.link_inertia) = (rotor, link);
            joint.compliance = compliance.map(|(stiffness, damping_ratio)| Compliance { stiffness, damping_ratio });
            joint.excitation = excitation;
            joint.damping_law = if contact { DampingLaw::Contact } else { DampingLaw::Paper };
            JointParameters { sun_planet, ring_planet, ..joint }
        },
    )
}

/// Scenario of a turning joint whose unbalanced torques change once.
pub fn scenario() -> impl Strategy<Value = Scenario> {
    (joint(), -100.0..100.0, -500.0..500.0, -100.0..100.0, -20.0..20.0).prop_map(
        |(joint, drive, load, later, speed)| {
            let planets = joint.geometry.planets;
            let segment = |from_tick, drive_torque, load_torque| TorqueSegment { from_tick, drive_torque, load_torque };
            let start = RelativeState { rigid_speed: speed, ..RelativeState::centred(planets) };
            let torques = vec![segment(0, drive, load), segment(60, later, -load)];
            let scenario = Scenario::new("random", joint, start);
            Scenario { torques, tick_rate: TICK_RATE, ticks: 120, predictable: false, ..scenario }
        },
    )
}

/// Configuration with a number of cases from a fixed seed, and no file of failures.
pub fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() }
}

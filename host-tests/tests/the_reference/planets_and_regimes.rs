//! Phase differences of planets by tooth counts, the four regimes of set P, and rejected joints.

use std::f64::consts::TAU;

use host_tests::tolerance::{POINCARE, TOOTH_PHASE};
use parameters::{DampingLaw, DeadZone, MeshPhases, StiffnessWave};
use reference::integrator::Counters;
use reference::joint::{Reference, RelativeState, Start};
use reference::scenarios::{
    PAPER_LENGTH, Scenario, paper_joint, paper_natural_frequency, poincare_point, regime, run, run_at, same,
};

/// omega/omega_n of set P.
const OMEGA: f64 = 2.1;

/// Linear joint without backlash and with constant stiffness, whose mesh phases follow from the tooth counts.
fn by_teeth(planets: usize, sun_teeth: u32, ring_teeth: u32) -> Scenario {
    let mut scenario = regime("by teeth", 0.0, 0.0);
    let joint = &mut scenario.joint;
    joint.geometry.planets = planets;
    joint.geometry.sun_teeth = sun_teeth;
    joint.geometry.ring_teeth = ring_teeth;
    for (mesh, phase) in [(&mut joint.sun_planet, 0.0), (&mut joint.ring_planet, 0.7)] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
        mesh.half_backlash = same(planets, 0.0);
        mesh.transmission_error = same(planets, 10e-6);
        mesh.phases = MeshPhases::FromTeeth { stiffness: 0.4, error: phase };
    }
    scenario.start = Start::Relative(RelativeState::centred(planets));
    scenario
}

/// Times tau = first + i period / parts [s].
fn parts_of_a_period(first: f64, parts: usize, count: usize) -> Vec<f64> {
    let period = TAU / OMEGA;
    let first = (first / period).ceil() * period;
    (0..count).map(|part| (first + period * part as f64 / parts as f64) / paper_natural_frequency()).collect()
}

/// Planets follow one another by the fraction of a tooth.
#[test]
fn planets_follow_by_tooth_fraction() {
    // Zs/n = 28/3 and 26/4: planet i leads by a third and by a half of a mesh period, on ring and sun.
    for (planets, sun_teeth, ring_teeth, lead) in [(3, 28, 98, 1), (4, 26, 98, 2), (5, 27, 98, 2)] {
        let times = parts_of_a_period(900.0, planets, 3 * planets);
        let found = run_at(&by_teeth(planets, sun_teeth, ring_teeth), &times).expect("it runs");
        for kind in [0, 1] {
            for planet in 1..planets {
                for sample in 0..planets {
                    let ahead = &found.samples[sample + (lead * planet) % planets];
                    let difference = found.samples[sample].deflections[kind][planet] - ahead.deflections[kind][0];
                    TOOTH_PHASE.check(difference / PAPER_LENGTH);
                }
            }
        }
        let spread = found.samples[0].deflections[0][1] - found.samples[0].deflections[0][0];
        assert!(spread.abs() > 0.1 * PAPER_LENGTH, "the planets are not in phase: {spread}");
    }
}

/// Planets with whole tooth counts move in phase.
#[test]
fn whole_tooth_counts_move_in_phase() {
    let mut scenario = by_teeth(3, 27, 99);
    for mesh in [&mut scenario.joint.sun_planet, &mut scenario.joint.ring_planet] {
        mesh.half_backlash = same(3, 10e-6);
        mesh.stiffness_wave = StiffnessWave::Rectangular { stiffness_ratio: 0.1, contact_ratio: 1.6, order: 5 };
    }
    let found = run_at(&scenario, &parts_of_a_period(100.0, 16, 16)).expect("it runs");
    assert!(found.counters.events > 0);
    for sample in &found.samples {
        for (kind, planet) in [(0, 1), (0, 2), (1, 1), (1, 2)] {
            let difference = sample.deflections[kind][planet] - sample.deflections[kind][0];
            TOOTH_PHASE.check(difference / PAPER_LENGTH);
        }
    }
}

/// Poincare points of set P after `skipped` mesh periods from rest.
fn points(half_backlash: f64, skipped: u32, count: u32) -> (Vec<[f64; 4]>, Counters) {
    let section = |k: u32| TAU * f64::from(k) / OMEGA / paper_natural_frequency();
    let times: Vec<f64> = (skipped..skipped + count).map(section).collect();
    let found = run_at(&regime("set P", half_backlash, 0.0), &times).expect("it runs");
    (found.samples.iter().map(poincare_point).collect(), found.counters)
}

fn distance(one: &[f64; 4], other: &[f64; 4]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Set P at 0 and 10 um has period one.
#[test]
fn set_p_at_0_and_10_um_has_period_one() {
    for (half_backlash, expected) in
        [(0.0, [-0.0678, 0.8675, -11.5051, -5.0495]), (10e-6, [0.3748, 1.4129, -9.0687, -2.7137])]
    {
        for point in points(half_backlash, 300, 3).0 {
            POINCARE.check(distance(&point, &expected));
        }
    }
}

/// Set P at 60 um has period three.
#[test]
fn set_p_at_60_um_has_period_three() {
    let expected =
        [[0.7489, 6.1283, -13.9408, -6.2729], [-6.2003, 0.6379, -4.3947, 0.8576], [6.5018, 10.4328, -2.1416, 3.4190]];
    let (found, _) = points(60e-6, 900, 6);
    let first = expected.iter().position(|point| distance(point, &found[0]) < 1.0).expect("one of the three points");
    // The phase of the cycle is not given: the three points must come in one order.
    for (index, point) in found.iter().enumerate() {
        let nearest = expected.iter().map(|expected| distance(expected, point)).fold(f64::INFINITY, f64::min);
        POINCARE.check(nearest);
        assert_eq!(index % 3 == 0, distance(&expected[first], point) < 1.0);
    }
}

/// Set P at 120 um never repeats.
#[test]
fn set_p_at_120_um_never_repeats() {
    let (found, counters) = points(120e-6, 300, 300);
    let mut distinct: Vec<[f64; 4]> = Vec::new();
    for point in found {
        if distinct.iter().all(|known| distance(known, &point) > 1e-2) {
            distinct.push(point);
        }
    }
    assert!(distinct.len() > 250, "{} distinct points of 300", distinct.len());
    assert_eq!(counters.unguarded_steps, 0);
}

/// Without backlash the law `contact` separates a mesh that would pull otherwise.
#[test]
fn contact_law_parts_without_backlash() {
    let mut scenario = regime("no backlash, law contact", 0.0, 200.0);
    scenario.joint.damping_law = DampingLaw::Contact;
    let found = run(&scenario).expect("it runs");
    for sample in &found.samples {
        for (deflection, force) in sample.deflections.iter().flatten().zip(sample.mesh_forces.iter().flatten()) {
            assert!(deflection * force >= 0.0, "flanks only push: {deflection} m, {force} N");
        }
    }
    // A zone of zero width is left as soon as it is entered: a few events a period, not an endless series.
    let periods = 200.0 * OMEGA / TAU;
    let each = found.counters.events as f64 / periods / 6.0;
    assert!((1.0..20.0).contains(&each), "{each} events for each mesh and period");
}

/// A joint at rest on the edge of every gap stays there.
#[test]
fn joint_on_every_edge_stays_there() {
    let mut joint = paper_joint(0.0, 0.0, 10e-6, 0.0);
    joint.damping_law = DampingLaw::Contact;
    let edge = RelativeState { sun_planet: same(3, 10e-6), gap: 20e-6, ..RelativeState::centred(3) };
    let mut reference = Reference::start(&joint, &Start::Relative(edge)).expect("a sound joint");
    reference.advance(0.1, 0.0, 0.0).expect("it runs");
    assert!((reference.observe().gap - 20e-6).abs() < 1e-12);
    assert!(reference.counters().steps < 10_000, "{:?}", reference.counters());
}

/// A tanh dead zone and unsound parameters are rejected with the remedy.
#[test]
fn unsound_joints_are_rejected() {
    let refusal = |change: fn(&mut parameters::JointParameters)| {
        let mut joint = paper_joint(0.1, 30e-6, 60e-6, OMEGA);
        change(&mut joint);
        Reference::new(&joint).expect_err("must be refused").to_string()
    };
    assert_eq!(
        refusal(|joint| joint.dead_zone = DeadZone::Tanh { sharpness: 1000.0 }),
        "the reference has no tanh dead zone; set the dead zone to sharp to compare with it"
    );
    assert_eq!(refusal(|joint| joint.geometry.planets = 2), "2 planets; the reference takes 3 to 5");
    assert_eq!(
        refusal(|joint| joint.sun_planet.mean_stiffness = -1.0),
        "mean mesh stiffness is -1; it must be positive and finite"
    );
    assert_eq!(
        refusal(|joint| joint.ring_planet.half_backlash = same(4, 1e-5)),
        "half-backlash has 4 values for 3 planets; give one for each"
    );
    assert_eq!(
        refusal(|joint| joint.rotor_inertia = f64::NAN),
        "rotor inertia is NaN; it must be zero or positive, and finite"
    );
}

//! Invariants of any integrator: energy against work, shift and scaling of the backlash, independence of whole turns, and predictability.

use std::f64::consts::TAU;

use host_tests::tolerance::{ENERGY, INVARIANCE, MANY_TURNS, PREDICTABILITY};
use parameters::{ContactState, DampingLaw, Mesh, StiffnessWave};
use reference::joint::{Observation, RelativeState, Start};
use reference::scenarios::{CASE_A_OMEGA, PAPER_LENGTH, Scenario, Trajectory, case, motions, regime, run, same};

fn meshes(scenario: &mut Scenario) -> [&mut Mesh; 2] {
    [&mut scenario.joint.sun_planet, &mut scenario.joint.ring_planet]
}

fn relative(scenario: &mut Scenario) -> &mut RelativeState {
    match &mut scenario.start {
        Start::Relative(state) => state,
        Start::Still => panic!("{} starts still", scenario.name),
    }
}

/// Largest difference of a signal between two runs, over b_c.
fn difference(one: &Trajectory, other: &Trajectory, of: impl Fn(&Observation, &Observation) -> f64) -> f64 {
    assert_eq!(one.samples.len(), other.samples.len());
    one.samples.iter().zip(&other.samples).map(|(a, b)| of(a, b).abs()).fold(0.0, f64::max) / PAPER_LENGTH
}

/// Energy equals the net work in every scenario.
#[test]
fn energy_equals_work_in_every_scenario() {
    let mut scenarios = motions();
    scenarios.push(case("case A", CASE_A_OMEGA));
    for half_backlash in [0.0, 10e-6, 60e-6, 120e-6] {
        scenarios.push(regime("set P", half_backlash, 1000.0));
    }
    let mut contact = regime("set P, law contact", 60e-6, 300.0);
    contact.joint.damping_law = DampingLaw::Contact;
    scenarios.push(contact);
    let mut rectangular = regime("set P, rectangular wave", 60e-6, 300.0);
    for mesh in meshes(&mut rectangular) {
        mesh.stiffness_wave = StiffnessWave::Rectangular { stiffness_ratio: 0.1, contact_ratio: 1.6, order: 8 };
    }
    scenarios.push(rectangular);
    for scenario in scenarios {
        let found = run(&scenario).expect("the scenario runs");
        let energy = |sample: &Observation| sample.kinetic_energy + sample.elastic_energy;
        let start = energy(&found.samples[0]);
        let largest = found.samples.iter().map(energy).fold(0.0, f64::max);
        let missing = found.samples.iter().map(|sample| (energy(sample) - start - sample.work.net()).abs());
        print!("{}, {:?}: ", scenario.name, found.counters);
        ENERGY.check(missing.fold(0.0, f64::max) / largest);
    }
}

/// Without back-side contact a wider backlash only shifts the motion.
#[test]
fn backlash_only_shifts_one_sided_motion() {
    let narrow = case("narrow", CASE_A_OMEGA);
    let mut wide = narrow.clone();
    let shift = 55e-6;
    for mesh in meshes(&mut wide) {
        mesh.half_backlash = same(3, 60e-6 + shift);
    }
    relative(&mut wide).sun_planet.iter_mut().for_each(|deflection| *deflection += shift);
    relative(&mut wide).gap += 2.0 * shift;
    let (narrow, wide) = (run(&narrow).expect("it runs"), run(&wide).expect("it runs"));
    assert!(narrow.counters.events > 100, "meshes part: {:?}", narrow.counters);
    let back_side = |sample: &Observation| sample.contacts.iter().flatten().any(|side| *side == ContactState::BackSide);
    assert!(!narrow.samples.iter().any(back_side), "no back-side contact");
    INVARIANCE.check(difference(&narrow, &wide, |a, b| b.gap - a.gap - 2.0 * shift));
    for kind in [0, 1] {
        for planet in 0..3 {
            let shifted =
                |a: &Observation, b: &Observation| b.deflections[kind][planet] - a.deflections[kind][planet] - shift;
            INVARIANCE.check(difference(&narrow, &wide, shifted));
        }
    }
}

/// Errors, torques, backlash and state scale together.
#[test]
fn all_lengths_scale_together() {
    let factor = 2.5;
    for law in [DampingLaw::Paper, DampingLaw::Contact] {
        let mut small = case("small", CASE_A_OMEGA);
        small.joint.damping_law = law;
        // 150 ticks end before the law `contact` has amplified rounding beyond the bound.
        small.ticks = 150;
        let mut large = small.clone();
        for mesh in meshes(&mut large) {
            mesh.half_backlash.iter_mut().for_each(|value| *value *= factor);
            mesh.transmission_error.iter_mut().for_each(|value| *value *= factor);
        }
        let state = relative(&mut large);
        state.sun_planet.iter_mut().chain(&mut state.sun_planet_rate).for_each(|value| *value *= factor);
        state.gap *= factor;
        for segment in &mut large.torques {
            segment.drive_torque *= factor;
            segment.load_torque *= factor;
        }
        let (small, large) = (run(&small).expect("it runs"), run(&large).expect("it runs"));
        assert!(small.counters.events > 100, "meshes part: {:?}", small.counters);
        for kind in [0, 1] {
            let scaled = |a: &Observation, b: &Observation| b.deflections[kind][0] / factor - a.deflections[kind][0];
            INVARIANCE.check(difference(&small, &large, scaled));
        }
    }
}

/// Mesh deflections depend neither on the speed nor on the turns of the joint.
#[test]
fn deflections_ignore_rigid_rotation() {
    let motion = motions().into_iter().find(|motion| motion.name == "L1 contact, reversal through the gap");
    let mut still = motion.expect("the motion is there");
    for mesh in meshes(&mut still) {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
        mesh.transmission_error = same(3, 0.0);
    }
    let mut turning = still.clone();
    relative(&mut turning).rigid_speed = 300.0;
    let (still, turning) = (run(&still).expect("it runs"), run(&turning).expect("it runs"));
    let last = turning.samples.last().expect("samples");
    let turns = 300.0 * last.time / TAU;
    assert!(turns > 9.0);
    MANY_TURNS.check((last.rigid_turns - turns) / turns);
    MANY_TURNS.check((last.link_angle - last.link_offset) / (TAU * turns) - 1.0);
    for kind in [0, 1] {
        MANY_TURNS.check(difference(&still, &turning, |a, b| b.deflections[kind][0] - a.deflections[kind][0]));
    }
    MANY_TURNS.check(difference(&still, &turning, |a, b| b.gap - a.gap));
}

/// Scenarios marked predictable, and no others, damp a change of one picometre.
#[test]
fn predictable_motions_damp_a_picometre() {
    const CHANGE: f64 = 1e-12;
    for scenario in motions() {
        let mut moved = scenario.clone();
        relative(&mut moved).gap += CHANGE;
        // Only one mesh changes: differences between planets grow faster than their common motion.
        moved.joint.sun_planet.half_backlash[0] += CHANGE;
        let (one, other) = (run(&scenario).expect("it runs"), run(&moved).expect("it runs"));
        let squares = one.samples.iter().zip(&other.samples).flat_map(|(a, b)| {
            let both = a.deflections.iter().flatten().zip(b.deflections.iter().flatten());
            both.map(|(a, b)| (a - b).powi(2)).collect::<Vec<f64>>()
        });
        let squares: Vec<f64> = squares.collect();
        let growth = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() / CHANGE;
        print!("{}: ", scenario.name);
        if scenario.predictable {
            PREDICTABILITY.check(growth);
        } else {
            println!("{growth:.1e}");
            assert!(growth > PREDICTABILITY.limit, "{} is predictable after all: {growth:e}", scenario.name);
        }
    }
}

//! One joint in three formulations without a common equation of motion: eqs 1-6 in absolute coordinates (the reference), eq. 19 written out
//! by hand, eq. 20 with the design's own H. All use the damping law `paper` and the sharp dead zone.

mod equation_19;
mod equation_20;
mod full_and_reduced;
mod joint;

use host_tests::tolerance::FORMULATIONS;
use model_core::gears::Mechanics;
use parameters::{ContactState, JointParameters, MeshPhases, PerPlanet};
use reference::integrator::Integrator;
use reference::joint::RelativeState;
use reference::scenarios::{PAPER_LENGTH, Scenario, TorqueSegment, paper_joint, paper_natural_frequency, run_at};

use equation_19::Equation19;
use equation_20::Equation20;
use joint::{Deflections, Formulation, Joint, OMEGA, System};

/// Drive torque [N m]: about 7 um of deflection a mesh, so that errors of 10 um separate it again and again.
const DRIVE_TORQUE: f64 = 80.0;
/// Number of samples of a run, and the dimensionless time between them.
const SAMPLES: u32 = 120;
const INTERVAL: f64 = 0.5;

/// The paper's joint with n planets out of phase, unequal backlash and two different meshes.
fn parameters(planets: usize) -> JointParameters {
    let mut joint = paper_joint(0.2, 10e-6, 60e-6, OMEGA);
    joint.geometry.planets = planets;
    joint.ring_planet.mean_stiffness = 1.2e8;
    joint.ring_planet.damping_ratio = 0.07;
    let per_planet = |of: &dyn Fn(f64) -> f64| -> PerPlanet { (0..planets).map(|planet| of(planet as f64)).collect() };
    for (mesh, offset) in [(&mut joint.sun_planet, 0.0), (&mut joint.ring_planet, 0.7)] {
        mesh.half_backlash = per_planet(&|planet| (20.0 + 4.0 * planet + 3.0 * offset) * 1e-6);
        mesh.transmission_error = per_planet(&|planet| (10.0 - planet + offset) * 1e-6);
        mesh.phases = MeshPhases::Given {
            stiffness: per_planet(&|planet| 2.1 * planet + offset + 0.4),
            error: per_planet(&|planet| 2.1 * planet + offset),
        };
    }
    joint
}

/// Runs the reference from X = X' = 0: through the gap, into contact, and through repeated separation.
fn reference(parameters: &JointParameters) -> Vec<Deflections> {
    let load_torque = parameters.balanced_load_torque(DRIVE_TORQUE);
    let planets = parameters.geometry.planets;
    let mut scenario = Scenario::new("three formulations", parameters.clone(), RelativeState::centred(planets));
    scenario.torques = vec![TorqueSegment { from_tick: 0, drive_torque: DRIVE_TORQUE, load_torque }];
    let times: Vec<f64> = (1..=SAMPLES).map(|k| f64::from(k) * INTERVAL / paper_natural_frequency()).collect();
    let found = run_at(&scenario, &times).expect("the reference follows");
    let contacts = || found.samples.iter().flat_map(|sample| sample.contacts.iter().flatten());
    assert!(found.counters.events > 50, "meshes part and hit: {:?}", found.counters);
    assert!(contacts().any(|side| *side == ContactState::Separated));
    let read = |kind: &PerPlanet| kind.iter().map(|value| value / PAPER_LENGTH).collect();
    found.samples.iter().map(|sample| sample.deflections.each_ref().map(read)).collect()
}

/// Integrates a formulation and returns its mesh deflections at the reference's times.
fn follow(joint: &Joint, formulation: impl Formulation) -> Vec<Deflections> {
    let mut integrator = Integrator::new(0.0, formulation.start(joint));
    let mut system = System { joint: joint.clone(), formulation };
    let sample = |k| {
        let time = f64::from(k) * INTERVAL;
        integrator.advance(&mut system, time).expect("it runs");
        system.deflections(time, integrator.state())
    };
    (1..=SAMPLES).map(sample).collect()
}

/// Largest difference of a mesh deflection, over b_c.
fn largest_difference(expected: &[Deflections], found: &[Deflections]) -> f64 {
    let pairs = expected.iter().flatten().flatten().zip(found.iter().flatten().flatten());
    pairs.map(|(expected, found)| (expected - found).abs()).fold(0.0, f64::max)
}

/// The three formulations give one motion, with 3 to 5 planets.
#[test]
fn formulations_give_one_motion() {
    for planets in 3..=5 {
        let parameters = parameters(planets);
        let expected = reference(&parameters);
        let joint = Joint::new(&parameters, DRIVE_TORQUE);
        FORMULATIONS.check(largest_difference(&expected, &follow(&joint, Equation19 { sum_of_the_second_row: true })));
        FORMULATIONS.check(largest_difference(&expected, &follow(&joint, Equation20::new(&parameters))));
    }
}

/// The printed second row has K_rp of one planet only (here the first), which gives a different motion.
#[test]
fn printed_equation_19_differs() {
    let parameters = parameters(3);
    let expected = reference(&parameters);
    let joint = Joint::new(&parameters, DRIVE_TORQUE);
    let difference = largest_difference(&expected, &follow(&joint, Equation19 { sum_of_the_second_row: false }));
    assert!(difference > 1.0, "the print differs by {difference} b_c only");
}

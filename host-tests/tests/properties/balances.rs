//! Balances of the reference: momentum against torques, energy against work, and teeth that only push.

use host_tests::tolerance::ENERGY;
use host_tests::tolerance::core::MOMENTUM;
use parameters::{ContactState, DampingLaw, JointParameters};
use proptest::prelude::*;
use reference::joint::{Observation, Start};
use reference::scenarios::{Scenario, TorqueSegment, run};

use crate::random::{config, scenario};

/// Acceleration of the rigid carrier per N m of drive and of load torque, computed by hand [1/(kg m^2)].
pub fn rigid_gains(joint: &JointParameters) -> [f64; 2] {
    let geometry = &joint.geometry;
    let cosine = geometry.working_pressure_angle.cos();
    let (lever, planets) = (geometry.carrier_radius * cosine, geometry.planets as f64);
    let sun = joint.bodies.sun_equivalent_mass + joint.rotor_inertia / geometry.sun_base_radius.powi(2);
    let carrier = (joint.bodies.carrier_inertia_over_radius_squared + planets * joint.bodies.planet_mass)
        / cosine.powi(2)
        + joint.link_inertia / lever.powi(2);
    let mass = 4.0 * sun + planets * joint.bodies.planet_equivalent_mass + carrier;
    [2.0 / (geometry.sun_base_radius * mass * lever), -1.0 / (lever * mass * lever)]
}

/// Speed of the rigid body from its initial speed and the torques, by its momentum [rad/s].
fn rigid_speed(scenario: &Scenario, time: f64) -> f64 {
    let Start::Relative(start) = &scenario.start else { unreachable!("scenarios here state their start") };
    let [drive, load] = rigid_gains(&scenario.joint);
    let gained = |segment: &TorqueSegment, end: f64| {
        let duration = end.min(time) - scenario.time_of(segment.from_tick).min(time);
        duration * (drive * segment.drive_torque + load * segment.load_torque)
    };
    let change = scenario.time_of(scenario.torques[1].from_tick);
    start.rigid_speed + gained(&scenario.torques[0], change) + gained(&scenario.torques[1], f64::INFINITY)
}

proptest! {
    #![proptest_config(config(48))]

    /// Energy equals work, and momentum the torques, on random joints.
    #[test]
    fn reference_balances_close(scenario in scenario()) {
        let samples = run(&scenario).expect("a sound joint runs").samples;
        let energy = |sample: &Observation| sample.kinetic_energy + sample.elastic_energy;
        let largest = samples.iter().map(energy).fold(0.0, f64::max);
        let fastest = samples.iter().map(|sample| sample.rigid_speed.abs()).fold(1.0, f64::max);
        let missing = |sample: &Observation| (energy(sample) - energy(&samples[0]) - sample.work.net()).abs();
        ENERGY.check(samples.iter().map(missing).fold(0.0, f64::max) / largest);
        let momentum_error = |sample: &Observation| (sample.rigid_speed - rigid_speed(&scenario, sample.time)).abs();
        MOMENTUM.check(samples.iter().map(momentum_error).fold(0.0, f64::max) / fastest);
    }

    /// With the damping law `contact` no tooth of the reference pulls.
    #[test]
    fn reference_teeth_only_push(mut scenario in scenario()) {
        scenario.joint.damping_law = DampingLaw::Contact;
        for sample in run(&scenario).expect("a sound joint runs").samples {
            for kind in [0, 1] {
                let forces = sample.mesh_forces[kind].iter().zip(&sample.contacts[kind]);
                for (force, contact) in forces {
                    let pushes = match contact {
                        ContactState::DriveSide => *force >= 0.0,
                        ContactState::Separated => *force == 0.0,
                        ContactState::BackSide => *force <= 0.0,
                    };
                    prop_assert!(pushes, "{force} N while {contact:?}");
                }
            }
        }
    }
}

//! Closed forms of two masses on a spring with a gap: rest positions and swings, without integration.

use std::f64::consts::{PI, TAU};

use host_tests::tolerance::equivalent;
use model_core::gears::design::design;
use model_core::gears::{Model, Tables, Torques};
use parameters::{EquivalentGear, JointParameters};
use reference::joint::{Reference, RelativeState, Start};
use simulation::sim::start::core_state;

const RATE: u32 = 20_000;

/// Joint with ratio 50.5, half the lost motion [rad] and a damping ratio.
fn joint(half: f64, damping_ratio: f64) -> JointParameters {
    let gear = EquivalentGear {
        ratio: [101, 2],
        lost_motion: 2.0 * half,
        stiffness: 40e3,
        damping_ratio,
        inertia_at_input: 0.4e-4,
    };
    gear.joint("closed".try_into().expect("a short name"), 0.8e-4, 0.6, 80.0)
}

/// Natural frequency of both sides against each other in contact [rad/s].
fn frequency() -> f64 {
    let at_link: f64 = 50.5 * 50.5 * 1.2e-4;
    (40e3 * (1.0 / at_link + 1.0 / 0.6)).sqrt()
}

/// Twist of core and reference, motor over the ratio less link, after some ticks from rest at a twist [rad].
fn twists(joint: &JointParameters, from: f64, ticks: u32, torques: (f64, f64)) -> [f64; 2] {
    let lever = joint.geometry.carrier_radius;
    let start = RelativeState {
        gap: 2.0 * from * lever,
        sun_planet: [from * lever].into_iter().collect(),
        ..RelativeState::centred(1)
    };
    let start = Start::Relative(start);
    let tables: Tables<f64, 1> = design(joint, RATE).expect("a sound joint");
    let mut model = Model::new(&tables);
    model.set_state(core_state(joint, &tables, &start));
    let mut reference = Reference::start(joint, &start).expect("a sound joint");
    for _ in 0..ticks {
        model.step(Torques { drive: torques.0, load: torques.1 });
    }
    reference.advance(f64::from(ticks) / f64::from(RATE), torques.0, torques.1).expect("it can be integrated");
    let (core, seen) = (model.outputs(), reference.observe());
    [core.motor_offset / 50.5 - core.link_offset, seen.motor_angle / 50.5 - seen.link_angle]
}

/// A balanced torque twists the gear by half the lost motion plus the elastic part.
#[test]
fn static_twist_matches_closed_form() {
    for (half, torque) in [(0.0, 30.0), (0.3e-3, 30.0), (0.3e-3, -70.0)] {
        // Five times the slowest decay.
        let found = twists(&joint(half, 0.2), 0.0, 12_000, (torque / 50.5, torque));
        let rests_at = half.copysign(torque) + torque / 40e3;
        for twist in found {
            equivalent::STATIC.check(twist / rests_at - 1.0);
        }
    }
}

/// A free swing has the period of the spring plus the time in the gap.
#[test]
fn free_swing_has_closed_period() {
    for (half, amplitude) in [(0.0, 1e-3), (0.2e-3, 1e-3), (1e-3, 0.4e-3)] {
        let period = (TAU + 4.0 * half / amplitude) / frequency();
        // After whole periods the twist is back at its start, except for the fraction of a tick.
        let ticks = (10.0 * period * f64::from(RATE)).round();
        let late = frequency() * (ticks / f64::from(RATE) - 10.0 * period);
        let expected = half + amplitude * late.cos();
        for twist in twists(&joint(half, 0.0), half + amplitude, ticks as u32, (0.0, 0.0)) {
            equivalent::FREE_SWING.check((twist - expected) / amplitude);
        }
    }
}

/// Under a torque, contact returns after the time of a parabolic flight.
#[test]
fn loaded_swing_has_closed_period() {
    let half = 2e-3;
    for (torque, share) in [(40.0, 1.5), (20.0, 3.0)] {
        // A swing about the rest position, larger than the rest deflection: the contact opens and closes again.
        let (rest, amplitude) = (torque / 40e3, share * torque / 40e3);
        let left: f64 = amplitude * amplitude - rest * rest;
        assert!(left / (2.0 * rest) < 2.0 * half, "the other flank is not reached");
        let period = (2.0 * (PI - (rest / amplitude).acos()) + 2.0 * left.sqrt() / rest) / frequency();
        let ticks = (5.0 * period * f64::from(RATE)).round();
        let late = frequency() * (ticks / f64::from(RATE) - 5.0 * period);
        let expected = half + rest + amplitude * late.cos();
        let found = twists(&joint(half, 0.0), half + rest + amplitude, ticks as u32, (torque / 50.5, torque));
        for twist in found {
            equivalent::FREE_SWING.check((twist - expected) / amplitude);
        }
    }
}

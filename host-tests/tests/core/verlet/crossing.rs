//! Contact changes between two ticks: a tooth parts and returns, or crosses its whole gap within one sub-step.

use host_tests::tolerance::light_planets::{PARTING_WITHIN_A_TICK, SUBSTEP_ACROSS_THE_GAP, SUBSTEP_THROUGH_THE_MIDDLE};
use model_core::gears::{Model, Torques};
use parameters::{ContactState, DampingLaw, JointParameters};
use reference::joint::{Observation, RelativeState};
use reference::scenarios::same;

use super::subject::{in_contact, joint, reference, state, verlet_only};

const RATE: u32 = 10_000;
const SUBSTEPS: u32 = 8;
/// Torque on the sun and balancing torque on the link [N m].
const TORQUES: (f64, f64) = (0.2, 1.2);
/// Samples of the reference within a tick.
const MOMENTS: u32 = 200;

/// Largest error of a deflection at the ends of the first ticks [m].
fn error<const N: usize>(joint: &JointParameters, start: &RelativeState, seen: &[Observation], substeps: u32) -> f64 {
    let tables = verlet_only::<N>(joint, RATE, substeps);
    let mut model = Model::new(&tables);
    model.set_state(state(joint, &tables, start));
    let mut worst = 0.0_f64;
    for end in seen.iter().skip(MOMENTS as usize).step_by(MOMENTS as usize) {
        model.step(Torques { drive: TORQUES.0, load: TORQUES.1 });
        let found = model.outputs().deflections;
        for (found, right) in found.iter().flatten().zip(end.deflections.iter().flatten()) {
            worst = worst.max((found - right).abs());
        }
    }
    worst
}

/// Successive contact states of the first sun-planet mesh.
fn contacts(seen: &[Observation]) -> Vec<ContactState> {
    let mut states: Vec<ContactState> = seen.iter().map(|seen| seen.contacts[0][0]).collect();
    states.dedup();
    states
}

fn check_parting<const N: usize>(law: DampingLaw) {
    let joint = joint(N, law);
    let mut start = in_contact(&joint, 0.5e-6);
    start.sun_planet_rate[0] = -0.1;
    let seen = reference(&joint, &start, TORQUES, MOMENTS * RATE, MOMENTS);
    let closed = ContactState::DriveSide;
    assert_eq!(contacts(&seen), [closed, ContactState::Separated, closed], "{N} planets, {law:?}");
    let deflections = || seen.iter().map(|seen| seen.deflections[0][0]);
    let swing = deflections().fold(f64::NEG_INFINITY, f64::max) - deflections().fold(f64::INFINITY, f64::min);
    PARTING_WITHIN_A_TICK.check(error::<N>(&joint, &start, &seen, SUBSTEPS) / swing);
}

fn check_crossing<const N: usize>(law: DampingLaw) {
    let mut joint = joint(N, law);
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash = same(N, 0.5e-6);
        mesh.transmission_error = same(N, 1e-6);
    }
    let mut start = in_contact(&joint, 0.2e-6);
    start.gap = 0.0;
    start.sun_planet_rate[0] = -0.2;
    let seen = reference(&joint, &start, TORQUES, MOMENTS * RATE, 2 * MOMENTS);
    // The flanks are hit within less than one sub-step.
    let substep = (MOMENTS / SUBSTEPS) as usize;
    let state = |moment: usize| seen[moment].contacts[0][0];
    let opposite = |from: usize| {
        let far = |to: usize| state(to) != state(from) && state(to) != ContactState::Separated;
        state(from) != ContactState::Separated && (from..=from + substep).any(far)
    };
    assert!((0..seen.len() - substep).any(opposite), "{N} planets, {law:?}");
    let largest = seen.iter().map(|seen| seen.deflections[0][0].abs()).fold(0.0, f64::max);
    SUBSTEP_ACROSS_THE_GAP.check(error::<N>(&joint, &start, &seen, SUBSTEPS) / largest);
    SUBSTEP_ACROSS_THE_GAP.check(10.0 * error::<N>(&joint, &start, &seen, 4 * SUBSTEPS) / largest);
}

/// Relative change of a planet's speed over one sub-step from flank to flank, equally deep in both.
fn speed_change<const N: usize>(law: DampingLaw) -> f64 {
    const SPEED: f64 = 0.2;
    let mut joint = joint(N, law);
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.damping_ratio = 0.0;
        mesh.half_backlash = same(N, 0.5e-6);
        mesh.transmission_error = same(N, 0.0);
    }
    let rate = RATE * SUBSTEPS;
    let half_way = 0.5 * SPEED / f64::from(rate);
    assert!(half_way > joint.sun_planet.half_backlash[0], "a sub-step crosses the whole gap");
    let mut start = RelativeState::centred(N);
    start.sun_planet[0] = half_way;
    start.sun_planet_rate[0] = -SPEED;
    let tables = verlet_only::<N>(&joint, rate, 1);
    let mut model = Model::new(&tables);
    let before = state(&joint, &tables, &start);
    model.set_state(before);
    model.step(Torques { drive: 0.0, load: 0.0 });
    model.state().rate.planets[0] / before.rate.planets[0] - 1.0
}

/// A sub-step from flank to flank, equally deep in both, leaves the planet's speed unchanged.
#[test]
fn symmetric_crossing_keeps_the_speed() {
    for law in [DampingLaw::Contact, DampingLaw::Paper] {
        SUBSTEP_THROUGH_THE_MIDDLE.check(speed_change::<3>(law));
        SUBSTEP_THROUGH_THE_MIDDLE.check(speed_change::<4>(law));
        SUBSTEP_THROUGH_THE_MIDDLE.check(speed_change::<5>(law));
    }
}

/// A tooth that parts and returns within a tick stays near the reference.
#[test]
fn parting_within_a_tick_is_resolved() {
    for law in [DampingLaw::Contact, DampingLaw::Paper] {
        check_parting::<3>(law);
        check_parting::<4>(law);
        check_parting::<5>(law);
    }
}

/// Sub-steps across the whole gap stay near the reference.
#[test]
fn crossing_substeps_follow_reference() {
    for law in [DampingLaw::Contact, DampingLaw::Paper] {
        check_crossing::<3>(law);
        check_crossing::<4>(law);
        check_crossing::<5>(law);
    }
}

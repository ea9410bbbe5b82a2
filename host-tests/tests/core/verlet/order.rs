//! Order of convergence of Verlet sub-steps on motions in which light planets lose and regain contact, for 3, 4 and 5 planets and both
//! damping laws. Ticks shrink with the sub-steps, since a tick takes ripple and errors from its middle.

use host_tests::tolerance::light_planets::{ORDER_OF_VERLET, SUBSTEPS};
use parameters::{ContactState, DampingLaw, JointParameters};
use reference::joint::{RelativeState, Start};

use super::subject::{in_contact, joint, reference, verlet_only};
use crate::comparison::rms_error;

/// Tick rate of the coarsest run [Hz], where samples are taken; Verlet sub-steps a tick.
const COARSEST_RATE: u32 = 10_000;
const SUBSTEPS_A_TICK: u32 = 8;
/// Length of the coarsest run [ticks].
const RUN_TICKS: u32 = 60;

/// Start on the drive side with planets pushed off the sun, which bounce back.
fn bouncing(joint: &JointParameters) -> RelativeState {
    let mut start = in_contact(joint, 0.0);
    start.gap -= 10e-6;
    start.gap_rate = 0.02;
    start
}

/// RMS errors at tick rates of COARSEST times 2^k, for each k.
fn errors<const N: usize>(joint: &JointParameters, doublings: &[u32]) -> Vec<f64> {
    let start = bouncing(joint);
    let expected = reference(joint, &start, (0.0, 0.0), COARSEST_RATE, RUN_TICKS);
    let is = |state| expected.iter().any(|seen| seen.contacts.iter().flatten().any(|contact| *contact == state));
    assert!(is(ContactState::Separated) && is(ContactState::DriveSide), "contact is lost and found again");
    let one = |doublings: &u32| {
        let tables = verlet_only::<N>(joint, COARSEST_RATE << doublings, SUBSTEPS_A_TICK);
        rms_error(joint, &tables, &Start::Relative(start.clone()), (0.0, 0.0), &expected)
    };
    doublings.iter().map(one).collect()
}

/// Mean slope of log error over log step.
fn order(errors: &[f64]) -> f64 {
    (errors[0] / errors[errors.len() - 1]).log2() / (errors.len() - 1) as f64
}

fn check_undamped<const N: usize>() {
    let mut joint = joint(N, DampingLaw::Contact);
    joint.sun_planet.damping_ratio = 0.0;
    joint.ring_planet.damping_ratio = 0.0;
    let order = order(&errors::<N>(&joint, &[3, 4, 5, 6]));
    println!("{N} planets, no mesh damping: order {order:.2}");
    ORDER_OF_VERLET.check((2.0 - order).max(0.0));
}

fn check_damped<const N: usize>() {
    for law in [DampingLaw::Contact, DampingLaw::Paper] {
        let errors = errors::<N>(&joint(N, law), &[0, 3, 4, 5, 6]);
        let order = order(&errors[1..]);
        println!("{N} planets, law {law:?}: order {order:.2}, {:.1e} at the coarsest", errors[0]);
        ORDER_OF_VERLET.check((1.0 - order).max(0.0));
        SUBSTEPS.check(errors[0]);
    }
}

/// Without mesh damping, sub-steps are of second order where meshes part and hit.
#[test]
fn undamped_verlet_is_of_second_order() {
    check_undamped::<3>();
    check_undamped::<4>();
    check_undamped::<5>();
}

/// Mesh damping is delayed by half a sub-step: first order with a small factor.
#[test]
fn damped_verlet_is_of_first_order() {
    check_damped::<3>();
    check_damped::<4>();
    check_damped::<5>();
}

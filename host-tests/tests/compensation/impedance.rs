//! Impedance mode: deviation of link and torque from the same law on teeth without backlash.

use host_tests::extent::{cases, is_long};
use host_tests::tolerance::compensation::{
    IMPEDANCE_DEVIATION, IMPEDANCE_OVER_RIVAL, IMPEDANCE_TORQUE, SOFT_SPRING_SWING,
};
use reference::closed_loop::deviation;
use reference::scenarios::l1;
use scenario::case::Case;
use scenario::controller::ControllerName;
use scenario::controller::ControllerName::{Impedance, LinkSpring, MotorSide};
use scenario::controller::Gains;
use scenario::execution::RunSpec;
use scenario::suite::Test;

use super::{case_of, changed, l1_train, on_reference, run_in, shipped};

/// Deviations of controllers with one law without backlash from that law, in a given case: link, RMS [rad], and torque [N m].
fn deviations_in<const N: usize>(
    test: &Test,
    case: &Case,
    seed: u64,
    controllers: [ControllerName; N],
) -> [(f64, f64); N] {
    let law = controllers[0].without_gap();
    assert!(controllers.iter().all(|controller| controller.without_gap() == law), "one law");
    let law = run_in(test, case, seed, RunSpec { without_gap: true, ..on_reference(law) });
    controllers.map(|controller| {
        let ours = run_in(test, case, seed, on_reference(controller));
        let (link, _, torque) = deviation(&ours.run, &law.run, test.file.settle);
        (link, torque)
    })
}

/// Deviations of controllers with one law in the case of a seed.
fn deviations_of<const N: usize>(test: &Test, seed: u64, controllers: [ControllerName; N]) -> [(f64, f64); N] {
    deviations_in(test, &test.case(seed).expect("a case of the test"), seed, controllers)
}

/// Shipped impedance test with another stiffness [N m/rad]; `alone` drops the feed-forward torque of the motion.
fn with_spring(name: &str, stiffness: f64, alone: bool) -> Test {
    let mut test = shipped(name);
    let gains = test.file.gains.expect("a test of an impedance");
    test.file.gains = Some(Gains { stiffness, inertia: if alone { Some(0.0) } else { gains.inertia }, ..gains });
    test
}

/// Checks the deviation against the rival with its spring at the link and its damper at the motor, and returns deviation and torque error
/// of the compensation.
fn check_against_best_rival(test: &Test, seed: u64) -> (f64, f64) {
    let [(ours, torque), (rival, _)] = deviations_of(test, seed, [Impedance, LinkSpring]);
    IMPEDANCE_OVER_RIVAL.check(ours / rival);
    (ours, torque)
}

fn check_against_gapless_law(test: &Test, seed: u64) {
    let (ours, torque) = check_against_best_rival(test, seed);
    let [(motor, motor_torque)] = deviations_of(test, seed, [MotorSide]);
    IMPEDANCE_DEVIATION.check(ours / motor);
    IMPEDANCE_TORQUE.check(torque / motor_torque);
}

/// A spring of medium stiffness follows its law without backlash.
#[test]
fn medium_spring_follows_gapless_law() {
    check_against_gapless_law(&shipped("impedance"), 121);
}

/// A stiff spring follows its law without backlash.
#[test]
fn stiff_spring_follows_gapless_law() {
    check_against_gapless_law(&shipped("impedance-stiff"), 122);
}

/// A stiff spring without feed-forward torque deviates no more than the best rival, in steps and in a hold.
#[test]
fn stiff_spring_matches_best_rival() {
    for &(name, seed) in cases(&[("impedance-steps", 123), ("impedance-hold", 124)], 1) {
        let test = with_spring(name, 600.0, true);
        if is_long() {
            check_against_gapless_law(&test, seed);
        } else {
            check_against_best_rival(&test, seed);
        }
    }
}

/// Steps with feed-forward torque deviate no more than the best rival.
#[test]
fn feedforward_steps_match_best_rival() {
    // The motor is near its limit, so torque missed by a late flank cannot be made up.
    for &(stiffness, seed) in cases(&[(100.0, 125), (300.0, 126), (600.0, 127)], 1) {
        check_against_best_rival(&with_spring("impedance-steps", stiffness, false), seed);
    }
}

/// An uncertain flank does not make a soft spring on a large joint oscillate.
#[test]
fn soft_spring_on_large_joint_is_stable() {
    let (test, seed) = (changed("impedance-steps", "joint = \"l1\"\nduration_s = 4", ""), 128);
    let [(swing, _)] = deviations_in(&test, &case_of(&test, seed, &l1(), &l1_train()), seed, [Impedance]);
    SOFT_SPRING_SWING.check(swing);
}

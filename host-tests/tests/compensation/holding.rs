//! Holding a position: under a disturbance, and after a push with and without dry friction.

use host_tests::tolerance::compensation::{
    FREE_HOLD_SWING, HOLD_OVER_PID, HOLD_SWING_OVER_PID, UNKNOWN_FREE_HOLD_SWING,
};
use reference::closed_loop::Figures;
use reference::drive_train::DriveTrainParameters;
use reference::scenarios::q1;
use scenario::trial::{Contender, Trial};

use super::{NO_PREVIEW, figures};

/// Q1's, 4b over twice the carrier's lever [rad].
const LOST_MOTION: f64 = 3.78e-3;

#[test]
fn a_disturbed_hold_moves_a_fraction_of_what_it_did() {
    let trial = Trial::disturbed_hold(&q1(), &DriveTrainParameters::q1(), 111);
    let (pid, ours) = (figures(&trial, Contender::MotorPid), figures(&trial, NO_PREVIEW));
    HOLD_OVER_PID.check(ours.rms / pid.rms);
    HOLD_SWING_OVER_PID.check(ours.peak_to_peak / pid.peak_to_peak);
}

#[test]
fn a_little_friction_ends_all_crossings() {
    let trial = Trial::free_hold(&q1(), &DriveTrainParameters::q1(), 0.1, 112);
    let run = trial.run(NO_PREVIEW).expect("the trial runs");
    let crossings = Figures::of(&run, 2.1).crossings;
    assert!(crossings <= 2, "{crossings} crossings");
    assert_eq!(Figures::of(&run, 4.0).crossings, 0, "crossings go on");
}

#[test]
fn without_any_friction_a_known_gap_is_crossed_seldom_and_swings_less_than_it_is_wide() {
    let trial = Trial::free_hold(&q1(), &DriveTrainParameters::q1(), 0.0, 113);
    let after = |contender| Figures::of(&trial.run(contender).expect("the trial runs"), 2.1);
    let ours = after(Contender::PerfectSight { preview: false });
    let cascade = after(Contender::LoadCascade);
    assert!(ours.crossings < cascade.crossings / 4, "{} crossings against {}", ours.crossings, cascade.crossings);
    FREE_HOLD_SWING.check(ours.peak_to_peak / LOST_MOTION);
}

#[test]
fn without_any_friction_a_gap_that_is_not_known_yet_is_learnt_from_the_first_soft_touches() {
    for seed in 114..120 {
        let trial = Trial::free_hold(&q1(), &DriveTrainParameters::q1(), 0.0, seed);
        let after = |contender| Figures::of(&trial.run(contender).expect("the trial runs"), 2.1);
        let (ours, cascade) = (after(NO_PREVIEW), after(Contender::LoadCascade));
        assert!(ours.crossings < cascade.crossings, "{} crossings against {}", ours.crossings, cascade.crossings);
        UNKNOWN_FREE_HOLD_SWING.check(ours.peak_to_peak / LOST_MOTION);
    }
}

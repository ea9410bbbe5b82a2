//! Holding a position: under a disturbance, and after a push with and without dry friction.

use host_tests::extent::cases;
use host_tests::tolerance::compensation::{
    FREE_HOLD_SWING, HOLD_OVER_PID, HOLD_SWING_OVER_PID, UNKNOWN_FREE_HOLD_OVER_PID, UNKNOWN_FREE_HOLD_SWING,
};
use reference::closed_loop::Figures;
use scenario::controller::ControllerName::{LoadCascade, MotorPid, NoPreview, TrueStateCompensation};

use super::{figures, run, shipped};

/// Lost motion of Q1: 4b over twice the carrier's lever [rad].
const LOST_MOTION: f64 = 3.78e-3;

/// A disturbed hold moves by a fraction of PID's motion.
#[test]
fn disturbed_hold_moves_less_than_pid() {
    let (test, seed) = (shipped("disturbed-hold"), 111);
    let (pid, ours) = (figures(&test, seed, MotorPid), figures(&test, seed, NoPreview));
    HOLD_OVER_PID.check(ours.rms / pid.rms);
    HOLD_SWING_OVER_PID.check(ours.peak_to_peak / pid.peak_to_peak);
}

/// Crossings end soon where there is dry friction.
#[test]
fn friction_ends_crossings() {
    let test = shipped("free-hold");
    let run = run(&test, 112, NoPreview).run;
    let crossings = Figures::of(&run, test.file.settle).crossings;
    assert!(crossings <= 2, "{crossings} crossings");
    assert_eq!(Figures::of(&run, 4.0).crossings, 0, "crossings go on");
}

/// The link rests a count beside its set-point, held by its own and the motor's friction. An integral that removed this error in two
/// seconds cost a crossing.
#[test]
fn error_held_by_friction_is_tolerated() {
    let run = run(&shipped("free-hold"), 18, NoPreview).run;
    assert_eq!(Figures::of(&run, 2.5).crossings, 0, "the gap is crossed for an error of a count");
}

/// With a known gap and no friction, crossings are rare and the motion is smaller than the gap.
#[test]
fn free_hold_with_known_gap_rarely_crosses() {
    let (test, seed) = (shipped("free-hold-no-friction"), 113);
    let (ours, cascade) = (figures(&test, seed, TrueStateCompensation), figures(&test, seed, LoadCascade));
    assert!(ours.crossings < cascade.crossings / 4, "{} crossings against {}", ours.crossings, cascade.crossings);
    FREE_HOLD_SWING.check(ours.peak_to_peak / LOST_MOTION);
}

/// With an unknown gap and no friction, the width is estimated from the first soft contacts.
#[test]
fn free_hold_learns_unknown_gap() {
    let test = shipped("free-hold-no-friction");
    // Plain control alone exceeds the bound with the first seed.
    for &seed in cases(&[116, 114, 115, 117, 118, 119], 1) {
        let (ours, cascade) = (figures(&test, seed, NoPreview), figures(&test, seed, LoadCascade));
        assert!(ours.crossings < cascade.crossings, "{} crossings against {}", ours.crossings, cascade.crossings);
        UNKNOWN_FREE_HOLD_SWING.check(ours.peak_to_peak / LOST_MOTION);
        UNKNOWN_FREE_HOLD_OVER_PID.check(ours.rms / figures(&test, seed, MotorPid).rms);
    }
}

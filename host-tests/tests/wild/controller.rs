//! Attacks on the controller of a joint in motion: no input makes a torque above the limit or a non-finite estimate, and a second after the
//! attack the link follows as accurately as before.

use super::attack::{Chance, PRESETS, Subject, Wild, hold, link_angle};

/// Start and duration of an attack, recovery time after it, and time over which errors are compared [s].
const BEGINS: f64 = 3.0;
const LASTS: f64 = 0.3;
const COMES_BACK: f64 = 1.0;
const JUDGED: f64 = 1.0;

/// Duration of wild set-points, after which a link of any joint returns within the recovery time [s].
const POINTS_LAST: f64 = 0.05;

/// Seeds of one attack: two in `cargo test`, `WILD_SEEDS` in the long form.
pub fn seeds() -> std::ops::Range<u64> {
    0..std::env::var("WILD_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(2)
}

/// RMS error of the link before an attack and a second after it [rad].
fn attacked(subject: &Subject, wild: Wild, seed: u64, name: &str) -> [f64; 2] {
    let mut chance = Chance::new(seed, &format!("{wild:?}"));
    let (mut joint, mut controller) = (subject.joint(), subject.controller());
    let lasts = if wild == Wild::SetPoints { POINTS_LAST } else { LASTS };
    let [begins, ends] = [BEGINS, BEGINS + lasts].map(|seconds| subject.periods(seconds));
    let [before, after] = [BEGINS - JUDGED, BEGINS + LASTS + COMES_BACK].map(|seconds| subject.periods(seconds));
    let last = after + subject.periods(JUDGED);
    let mut sums = [0.0_f64; 2];
    for period in 0..last {
        let (mut samples, mut command) = (joint.samples(), subject.swing(period));
        let origin = command;
        if (begins..ends).contains(&period) {
            wild.spoil(&mut chance, subject.limit, &mut samples, &mut command);
        }
        let answer = controller.step(&samples, &command);
        hold(&answer, subject.limit, &|| format!("{name}, {wild:?}, seed {seed}, period {period}"));
        joint.advance(answer.shaped.torque, 0.0);
        if let model_core::compensation::Command::Position { now, .. } = origin {
            let error = link_angle(&joint) - std::f64::consts::TAU * f64::from(now.position.fraction);
            if (before..begins).contains(&period) {
                sums[0] += error * error;
            } else if period >= after {
                sums[1] += error * error;
            }
        }
    }
    sums.map(|sum| (sum / f64::from(subject.periods(JUDGED))).sqrt())
}

fn survives(wild: Wild) {
    let mut failures = Vec::new();
    for name in PRESETS {
        let subject = Subject::preset(name);
        for seed in seeds() {
            let [before, after] = attacked(&subject, wild, seed, name);
            println!("{name}, {wild:?}, seed {seed}: RMS {:.3} mrad before, {:.3} after", 1e3 * before, 1e3 * after);
            if after > 1.5 * before + 0.2e-3 {
                failures.push(format!(
                    "{name}, seed {seed}: {:.3} mrad before, {:.3} after",
                    1e3 * before,
                    1e3 * after
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{wild:?} leaves the link worse: {failures:#?}");
}

/// Non-finite or huge torque samples leave no lasting error.
#[test]
fn a_torque_that_no_motor_gives_is_none() {
    survives(Wild::Torque);
}

/// Torque samples of a few times the limit leave no lasting error.
#[test]
fn torques_of_a_few_times_the_limit_leave_nothing_behind() {
    survives(Wild::StrongTorque);
}

/// Random output counts leave no lasting error.
#[test]
fn counts_of_the_output_that_are_anything_leave_nothing_behind() {
    survives(Wild::OutputCounts);
}

/// Intermittent output readings leave no lasting error.
#[test]
fn readings_of_the_output_that_come_and_go_leave_nothing_behind() {
    survives(Wild::OutputMissing);
}

/// Time stamps in any order leave no lasting error.
#[test]
fn times_in_any_order_leave_nothing_behind() {
    survives(Wild::Times);
}

/// Set-points of random bits leave no lasting error.
#[test]
fn set_points_of_any_bits_leave_nothing_behind() {
    survives(Wild::SetPoints);
}

/// All attacks at once make neither a torque above the limit nor a non-finite estimate.
#[test]
fn everything_at_once_makes_no_torque_beyond_the_limit_and_no_estimate_that_is_no_number() {
    for name in PRESETS {
        let subject = Subject::preset(name);
        for seed in seeds() {
            let rms = attacked(&subject, Wild::Everything, seed, name);
            println!("{name}, seed {seed}: {rms:?}");
        }
    }
}

//! Attacks on the controller of a joint in motion: no input makes a torque above the limit or a non-finite estimate, and a second after the
//! attack the link follows as accurately as before.

use super::attack::{Attack, PRESETS, RandomValues, Subject, check_answer, link_angle};

/// Start and duration of an attack, recovery time after it, and time over which errors are compared [s].
const ATTACK_START: f64 = 3.0;
const ATTACK_DURATION: f64 = 0.3;
const RECOVERY_TIME: f64 = 1.0;
const COMPARED_TIME: f64 = 1.0;

/// Duration of wild set-points, after which a link of any joint returns within the recovery time [s].
const SET_POINT_ATTACK_DURATION: f64 = 0.05;

/// Seeds of one attack: one in `cargo test`, `WILD_SEEDS` in the long form.
pub fn seeds() -> std::ops::Range<u64> {
    0..std::env::var("WILD_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(1)
}

/// RMS error of the link before an attack and a second after it [rad].
fn attacked(subject: &Subject, attack: Attack, seed: u64, name: &str) -> [f64; 2] {
    let mut random = RandomValues::new(seed, &format!("{attack:?}"));
    let (mut joint, mut controller) = (subject.joint(), subject.controller());
    let lasts = if attack == Attack::SetPoints { SET_POINT_ATTACK_DURATION } else { ATTACK_DURATION };
    let [begins, ends] = [ATTACK_START, ATTACK_START + lasts].map(|seconds| subject.periods(seconds));
    let [before, after] = [ATTACK_START - COMPARED_TIME, ATTACK_START + ATTACK_DURATION + RECOVERY_TIME]
        .map(|seconds| subject.periods(seconds));
    let last = after + subject.periods(COMPARED_TIME);
    let mut sums = [0.0_f64; 2];
    for period in 0..last {
        let (mut samples, mut command) = (joint.samples(), subject.swing(period));
        let origin = command;
        if (begins..ends).contains(&period) {
            attack.apply(&mut random, subject.limit, &mut samples, &mut command);
        }
        let answer = controller.step(&samples, &command);
        check_answer(&answer, subject.limit, &|| format!("{name}, {attack:?}, seed {seed}, period {period}"));
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
    sums.map(|sum| (sum / f64::from(subject.periods(COMPARED_TIME))).sqrt())
}

fn check_recovery(attack: Attack) {
    let mut failures = Vec::new();
    for name in PRESETS {
        let subject = Subject::preset(name);
        for seed in seeds() {
            let [before, after] = attacked(&subject, attack, seed, name);
            println!("{name}, {attack:?}, seed {seed}: RMS {:.3} mrad before, {:.3} after", 1e3 * before, 1e3 * after);
            if after > 1.5 * before + 0.2e-3 {
                failures.push(format!(
                    "{name}, seed {seed}: {:.3} mrad before, {:.3} after",
                    1e3 * before,
                    1e3 * after
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{attack:?} leaves the link worse: {failures:#?}");
}

/// Non-finite or huge torque samples leave no lasting error.
#[test]
fn impossible_torques_leave_no_error() {
    check_recovery(Attack::Torque);
}

/// Torque samples of a few times the limit leave no lasting error.
#[test]
fn excessive_torques_leave_no_error() {
    check_recovery(Attack::StrongTorque);
}

/// Random output counts leave no lasting error.
#[test]
fn random_output_counts_leave_no_error() {
    check_recovery(Attack::OutputCounts);
}

/// Intermittent output readings leave no lasting error.
#[test]
fn intermittent_output_leaves_no_error() {
    check_recovery(Attack::OutputMissing);
}

/// Time stamps in any order leave no lasting error.
#[test]
fn unordered_times_leave_no_error() {
    check_recovery(Attack::Times);
}

/// Set-points of random bits leave no lasting error.
#[test]
fn random_set_points_leave_no_error() {
    check_recovery(Attack::SetPoints);
}

/// All attacks at once make neither a torque above the limit nor a non-finite estimate.
#[test]
fn all_attacks_keep_limits_and_finiteness() {
    for name in PRESETS {
        let subject = Subject::preset(name);
        for seed in seeds() {
            let rms = attacked(&subject, Attack::Everything, seed, name);
            println!("{name}, seed {seed}: {rms:?}");
        }
    }
}

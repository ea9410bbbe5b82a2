//! Attacks on the controller of a joint in motion: nothing that is put in makes a torque beyond the limit or an estimate that
//! is no number, and a second after the attack the link follows as well as before.

use super::attack::{Chance, PRESETS, Subject, Wild, hold, link_angle};

/// When the attack begins, how long it lasts, and the time after it that is judged [s].
const BEGINS: f64 = 3.0;
const LASTS: f64 = 0.3;
const COMES_BACK: f64 = 1.0;
const JUDGED: f64 = 1.0;

/// Set-points are wild for so long that a link of any joint finds back within that time [s].
const POINTS_LAST: f64 = 0.05;

/// Seeds of one attack: one in `cargo test`, as many as the long form asks for.
pub fn seeds() -> std::ops::Range<u64> {
    0..std::env::var("WILD_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(2)
}

/// RMS error of the link before an attack and a second after it [rad], and the half of the lost motion [rad].
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

#[test]
fn a_torque_that_no_motor_gives_is_none() {
    survives(Wild::Torque);
}

#[test]
fn torques_of_a_few_times_the_limit_leave_nothing_behind() {
    survives(Wild::StrongTorque);
}

#[test]
fn counts_of_the_output_that_are_anything_leave_nothing_behind() {
    survives(Wild::OutputCounts);
}

#[test]
fn readings_of_the_output_that_come_and_go_leave_nothing_behind() {
    survives(Wild::OutputMissing);
}

#[test]
fn times_in_any_order_leave_nothing_behind() {
    survives(Wild::Times);
}

#[test]
fn set_points_of_any_bits_leave_nothing_behind() {
    survives(Wild::SetPoints);
}

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

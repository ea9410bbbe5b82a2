//! Position mode, with and without preview, against motor PID and the best rival.

use std::sync::LazyLock;

use host_tests::extent::{cases, is_long};
use host_tests::tolerance::compensation::{
    COMPENSATED_OVER_PID, COMPENSATED_OVER_RIVAL, COMPENSATED_PEAK_OVER_PID, COMPENSATED_PEAK_OVER_RIVAL,
    CROSSING_TIME, CROSSING_TIME_WITHOUT_PREVIEW, HIDDEN_GAP_OVER_PID, ONE_FLANK_OVER_PID, PEAK_MESH_FORCE,
    SLOW_OVER_PID, SLOW_PEAK_OVER_PID, STEPS_MESH_FORCE, STEPS_OVER_PID, STEPS_PEAK_OVER_PID, STIFF_JOINT_OVER_PID,
    STIFF_JOINT_STEPS_OVER_PID, TRANSMISSION_ERROR_OVER_PID,
};
use parameters::{AbsoluteEncoder, JointParameters};
use reference::closed_loop::Figures;
use reference::drive_train::DriveTrainParameters;
use reference::scenarios::{l1, q1};
use scenario::case::Case;
use scenario::controller::ControllerName;
use scenario::controller::ControllerName::{MotorPid, NoPreview, OutputIntegral, Preview};
use scenario::file::Trajectory;
use scenario::suite::Test;

use super::{case_of, changed, figures, figures_in, l1_train, shipped};

/// Net force of the sun's meshes at 15 N m on the link, the motor's torque limit [N].
const RATED_FORCE: f64 = 355.0;

/// Figures of one controller and of motor PID, on a given case.
fn against_pid(test: &Test, case: &Case, seed: u64, ours: ControllerName) -> [Figures; 2] {
    [ours, MotorPid].map(|controller| figures_in(test, case, seed, controller))
}

/// Q1's drive train with ideal encoders, for bounds that exclude encoder errors.
fn with_ideal_encoders() -> DriveTrainParameters {
    let mut train = DriveTrainParameters::q1();
    train.surroundings.motor_encoder = AbsoluteEncoder::ideal(18);
    train.surroundings.output_encoder = AbsoluteEncoder::ideal(18);
    train
}

/// Q1 with another torsional stiffness [N m/rad].
fn with_compliance(stiffness: f64) -> JointParameters {
    let mut joint = q1();
    if let Some(compliance) = &mut joint.compliance {
        compliance.stiffness = stiffness;
    }
    joint
}

/// Joint with a transmission error of `size` at each mesh [m].
fn with_transmission_error(mut joint: JointParameters, size: f64) -> JointParameters {
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.transmission_error.iter_mut().for_each(|error| *error = size);
    }
    joint
}

/// Modes of the compensation; the short form runs the first.
const PREVIEW_FIRST: [ControllerName; 2] = [Preview, NoPreview];
const NO_PREVIEW_FIRST: [ControllerName; 2] = [NoPreview, Preview];

fn check_against_rivals(test: &Test, seed: u64, modes: &[ControllerName; 2]) {
    check_case_against_rivals(test, &test.case(seed).expect("a case of the test"), seed, modes);
}

fn check_case_against_rivals(test: &Test, case: &Case, seed: u64, modes: &[ControllerName; 2]) {
    let [pid, rival] = [MotorPid, OutputIntegral].map(|rival| figures_in(test, case, seed, rival));
    for &controller in cases(modes, 1) {
        let ours = figures_in(test, case, seed, controller);
        println!("{} {}: {ours:?}", test.stem(), controller.word());
        COMPENSATED_OVER_PID.check(ours.rms / pid.rms);
        COMPENSATED_PEAK_OVER_PID.check(ours.peak / pid.peak);
        COMPENSATED_OVER_RIVAL.check(ours.rms / rival.rms);
        COMPENSATED_PEAK_OVER_RIVAL.check(ours.peak / rival.peak);
        CROSSING_TIME.check(ours.lost_motion_time);
        PEAK_MESH_FORCE.check(ours.peak_mesh_force / RATED_FORCE);
    }
}

/// The compensation beats motor PID and rival in slow motion, in which friction dominates.
#[test]
fn slow_motion_beats_rivals() {
    check_against_rivals(&shipped("t1"), 101, &PREVIEW_FIRST);
}

/// The compensation beats motor PID and rival in fast motion, in which inertia dominates.
#[test]
fn inertial_motion_beats_rivals() {
    check_against_rivals(&shipped("t2"), 102, &NO_PREVIEW_FIRST);
}

/// The compensation beats motor PID and rival under a swinging weight.
#[test]
fn swinging_weight_beats_rivals() {
    check_against_rivals(&shipped("t2b"), 103, &NO_PREVIEW_FIRST);
}

/// Without preview, a slow weight causes few crossings back to the flank just left.
#[test]
#[ignore = "half a minute and more: .ci/attack"]
fn slow_weight_causes_few_needless_crossings() {
    // There are seven reversals from three seconds on; each crossing in excess of seven is needless, as half of a pair
    // to and fro.
    let (test, seeds) = (shipped("t2b-slow-no-preview"), 301..349);
    let figures = |seed| figures_in(&test, &case_of(&test, seed, &q1(), &DriveTrainParameters::q1()), seed, NoPreview);
    let ours: Vec<_> = seeds.map(figures).collect();
    let needless: usize = ours.iter().map(|ours| ours.crossings - 7).sum();
    println!("{needless} needless crossings beside 336");
    // Measured: 44, and 24 with a load that is always followed in 3 ms. The bound is 1.5 times the first.
    assert!(needless <= 66, "{needless} needless crossings beside 336");
    // A needless crossing lengthens the mean of its own short record, so the bound applies to the mean of all records.
    CROSSING_TIME.check(ours.iter().map(|ours| ours.lost_motion_time).sum::<f64>() / ours.len() as f64);
    for ours in ours {
        CROSSING_TIME_WITHOUT_PREVIEW.check(ours.lost_motion_time);
    }
}

/// The compensation beats motor PID and rival in random motion.
#[test]
fn random_motion_beats_rivals() {
    check_against_rivals(&shipped("random"), 104, &PREVIEW_FIRST);
}

/// Fast steps without preview beat motor PID.
#[test]
fn steps_without_preview_beat_pid() {
    let (test, seed) = (shipped("steps-no-preview"), 105);
    let (ours, pid) = (figures(&test, seed, NoPreview), figures(&test, seed, MotorPid));
    STEPS_OVER_PID.check(ours.rms / pid.rms);
    STEPS_PEAK_OVER_PID.check(ours.peak / pid.peak);
}

/// Oscillation of motor and link does not exceed the mesh force limit, on a stiff and a soft train.
#[test]
fn oscillation_keeps_mesh_force_limit() {
    let (test, seed) = (shipped("steps-no-preview"), 112);
    for &stiffness in cases(&[20e3, 6e3], 1) {
        let case = case_of(&test, seed, &with_compliance(stiffness), &DriveTrainParameters::q1());
        let ours = figures_in(&test, &case, seed, NoPreview);
        println!("{stiffness}: {ours:?}");
        STEPS_MESH_FORCE.check(ours.peak_mesh_force / RATED_FORCE);
    }
}

/// Large stiff joint in motion.
#[test]
fn large_joint_beats_pid() {
    let (test, seed) = (shipped("l1"), 106);
    let [ours, pid] = against_pid(&test, &case_of(&test, seed, &l1(), &l1_train()), seed, Preview);
    STIFF_JOINT_OVER_PID.check(ours.rms / pid.rms);
}

/// Large stiff joint in steps.
#[test]
fn large_joint_steps_match_pid() {
    let (test, seed) = (changed("steps-no-preview", "joint = \"l1\"", ""), 109);
    let [ours, pid] = against_pid(&test, &case_of(&test, seed, &l1(), &l1_train()), seed, Preview);
    STIFF_JOINT_STEPS_OVER_PID.check(ours.rms / pid.rms);
}

/// Figures of the compensation and of motor PID in slow motion with ideal encoders.
fn slow_with_ideal_encoders(seed: u64) -> [Figures; 2] {
    let test = shipped("t1");
    against_pid(&test, &case_of(&test, seed, &q1(), &with_ideal_encoders()), seed, Preview)
}

/// Figures of one seed, for both tests of the short form.
static SLOW_WITH_IDEAL_ENCODERS: LazyLock<[Figures; 2]> = LazyLock::new(|| slow_with_ideal_encoders(110));

/// Friction is separated from weight before the gap is known.
#[test]
fn friction_is_separated_from_weight() {
    let [ours, pid] = &*SLOW_WITH_IDEAL_ENCODERS;
    SLOW_PEAK_OVER_PID.check(ours.peak / pid.peak);
}

/// Torque attributed to the motor stays in the feed-forward term long after it was last measured.
#[test]
fn motor_loss_feedforward_persists() {
    let [ours, pid] = if is_long() { &slow_with_ideal_encoders(111) } else { &*SLOW_WITH_IDEAL_ENCODERS };
    SLOW_OVER_PID.check(ours.rms / pid.rms);
}

/// A stiff train with an uncertain encoder offset lands softly.
#[test]
fn stiff_train_lands_softly() {
    let joint = with_transmission_error(with_compliance(34.4e3), 3e-6);
    let (test, seed) = (shipped("t2"), 2);
    let ours = figures_in(&test, &case_of(&test, seed, &joint, &DriveTrainParameters::q1()), seed, Preview);
    PEAK_MESH_FORCE.check(ours.peak_mesh_force / RATED_FORCE);
}

/// A torque constant wrong by 5 % costs little.
#[test]
fn wrong_torque_constant_costs_little() {
    check_against_rivals(&changed("t2", "", "[known]\ntorque_constant_error_ratio = 0.05"), 107, &PREVIEW_FIRST);
}

/// Gears with a transmission error at each mesh.
#[test]
fn transmission_error_beats_rivals() {
    // With flanks moved by 12 of 80 um, contact depends on the position within a pitch: on the file's own joint, encoder noise decides
    // whether a crossing counts 7 or 25 ms.
    let (test, seed) = (shipped("t2b"), 108);
    let case = case_of(&test, seed, &with_transmission_error(q1(), 6e-6), &DriveTrainParameters::q1());
    check_case_against_rivals(&test, &case, seed, &NO_PREVIEW_FIRST);
}

/// Load torque is fed forward although a transmission error as large as the gap hides the gap.
#[test]
fn hidden_gap_keeps_load_feedforward() {
    let mut joint = with_transmission_error(q1(), 14e-6);
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash.iter_mut().for_each(|half| *half = 7e-6);
    }
    let (test, seed) = (shipped("t2b"), 113);
    let [ours, pid] = against_pid(&test, &case_of(&test, seed, &joint, &DriveTrainParameters::q1()), seed, NoPreview);
    HIDDEN_GAP_OVER_PID.check(ours.rms / pid.rms);
}

/// A load that holds one flank is positioned correctly although the gap is never known.
#[test]
fn one_flank_load_is_positioned() {
    let push = "[[disturbance]]\nkind = \"pulse\"\nstart_s = 0\nlength_s = 100\ntorque_N_m = 4";
    let (mut test, seed) = (changed("t2-no-preview", "", push), 114);
    test.file.profile.trajectory = Trajectory::Sine(0.1, 0.5);
    let [ours, pid] = against_pid(&test, &case_of(&test, seed, &q1(), &DriveTrainParameters::q1()), seed, NoPreview);
    ONE_FLANK_OVER_PID.check(ours.rms / pid.rms);
}

/// The motor follows flanks that a transmission error moves.
#[test]
fn motor_follows_transmission_error() {
    // A motor at the link's speed would be late at every tooth.
    let (test, joint) = (shipped("t2"), with_transmission_error(q1(), 12e-6));
    let ratios = cases(&[110, 109, 108], 1).iter().map(|&seed| {
        let case = case_of(&test, seed, &joint, &DriveTrainParameters::q1());
        let [ours, pid] = against_pid(&test, &case, seed, Preview);
        ours.rms / pid.rms
    });
    let ratios: Vec<f64> = ratios.collect();
    println!("{ratios:?}");
    TRANSMISSION_ERROR_OVER_PID.check(ratios.iter().sum::<f64>() / ratios.len() as f64);
}

//! Impedance mode: how far the link and its torque are from what the same law does on teeth without backlash.

use host_tests::tolerance::compensation::{
    IMPEDANCE_DEVIATION, IMPEDANCE_OVER_RIVAL, IMPEDANCE_TORQUE, SOFT_SPRING_SWING,
};
use parameters::Surroundings;
use reference::closed_loop::rivals::ImpedanceLaw;
use reference::closed_loop::{ImpedanceGains, deviation};
use reference::drive_train::DriveTrainParameters;
use reference::scenarios::{l1, q1};
use scenario::trial::{Contender, Trial};

use super::NO_PREVIEW;

/// How far a contender is from what a law does without a gap: link (root mean square and largest) and torque.
fn deviations_from(trial: &Trial, law: ImpedanceLaw) -> impl Fn(Contender) -> (f64, f64, f64) {
    let run = |contender| trial.run(contender).expect("the trial runs");
    let without_gap = run(Contender::ImpedanceNoGap(law));
    move |contender| deviation(&run(contender), &without_gap, trial.from)
}

/// Deviation and torque error with compensation, whose law has its spring at the link and its damper at the motor; the
/// deviation held against that of the rival with the same law.
fn no_worse_than_the_best_rival(trial: &Trial) -> (f64, f64) {
    let deviations = deviations_from(trial, ImpedanceLaw::LinkSpring);
    let (ours, _, torque) = deviations(NO_PREVIEW);
    let (rival, _, _) = deviations(Contender::Impedance(ImpedanceLaw::LinkSpring));
    IMPEDANCE_OVER_RIVAL.check(ours / rival);
    (ours, torque)
}

fn comes_near_the_law_without_a_gap(trial: &Trial) {
    let (ours, torque) = no_worse_than_the_best_rival(trial);
    let (motor, _, motor_torque) =
        deviations_from(trial, ImpedanceLaw::MotorSide)(Contender::Impedance(ImpedanceLaw::MotorSide));
    IMPEDANCE_DEVIATION.check(ours / motor);
    IMPEDANCE_TORQUE.check(torque / motor_torque);
}

#[test]
fn a_medium_spring_behaves_as_if_there_were_no_gap() {
    comes_near_the_law_without_a_gap(
        &Trial::inertial(&q1(), &DriveTrainParameters::q1(), 121).with_impedance(300.0, 3.0),
    );
}

#[test]
fn a_stiff_spring_behaves_as_if_there_were_no_gap() {
    comes_near_the_law_without_a_gap(
        &Trial::random(&q1(), &DriveTrainParameters::q1(), 122).with_impedance(600.0, 3.0),
    );
}

#[test]
fn a_stiff_spring_steps_and_holds_no_worse_than_its_best_rival() {
    let (joint, train) = (q1(), DriveTrainParameters::q1());
    for trial in [Trial::steps(&joint, &train, 123), Trial::disturbed_hold(&joint, &train, 124)] {
        let mut trial = trial.with_impedance(600.0, 3.0);
        // Spring and damper alone.
        trial.bench.impedance = trial.bench.impedance.map(|gains| ImpedanceGains { inertia: 0.0, ..gains });
        comes_near_the_law_without_a_gap(&trial);
    }
}

#[test]
fn steps_with_their_own_torque_sent_along_are_no_worse_than_the_best_rival() {
    // The motor is near its limit then, and whatever a flank comes late is missing.
    for (stiffness, seed) in [(100.0, 125), (300.0, 126), (600.0, 127)] {
        let trial = Trial::steps(&q1(), &DriveTrainParameters::q1(), seed).with_impedance(stiffness, 3.0);
        no_worse_than_the_best_rival(&trial);
    }
}

#[test]
fn a_soft_spring_on_a_large_joint_does_not_swing_in_the_doubt_about_its_flank() {
    let train = Surroundings { delay: 1.0, torque_limit: 120.0, ..Surroundings::ideal() }.into();
    let mut trial = Trial::steps(&l1(), &train, 128).with_impedance(300.0, 3.0);
    trial.bench.duration = 4.0;
    let (swing, _, _) = deviations_from(&trial, ImpedanceLaw::LinkSpring)(NO_PREVIEW);
    SOFT_SPRING_SWING.check(swing);
}

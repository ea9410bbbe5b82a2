//! Impedance mode: how far the link and its torque are from what the same law does on teeth without backlash.

use host_tests::closed_loop::rivals::ImpedanceLaw;
use host_tests::closed_loop::{Contender, ImpedanceGains, Trial, deviation};
use host_tests::drive_train::DriveTrainParameters;
use host_tests::scenarios::{l1, q1};
use host_tests::tolerance::compensation::{
    IMPEDANCE_DEVIATION, IMPEDANCE_OVER_RIVAL, IMPEDANCE_TORQUE, SOFT_SPRING_SWING,
};

use super::NO_PREVIEW;

fn comes_near_the_law_without_a_gap(trial: &Trial) {
    let run = |contender| trial.run(contender).expect("the trial runs");
    let of = |law, contender| deviation(&run(contender), &run(Contender::ImpedanceNoGap(law)), trial.from);
    let (motor, _, motor_torque) = of(ImpedanceLaw::MotorSide, Contender::Impedance(ImpedanceLaw::MotorSide));
    // The compensation's law has its spring at the link and its damper at the motor.
    let (ours, _, torque) = of(ImpedanceLaw::LinkSpring, NO_PREVIEW);
    let rival = of(ImpedanceLaw::LinkSpring, Contender::Impedance(ImpedanceLaw::LinkSpring)).0;
    IMPEDANCE_OVER_RIVAL.check(ours / rival);
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
        let run = |contender| trial.run(contender).expect("the trial runs");
        let law = run(Contender::ImpedanceNoGap(ImpedanceLaw::LinkSpring));
        let of = |contender| deviation(&run(contender), &law, trial.from).0;
        let (ours, rival) = (of(NO_PREVIEW), of(Contender::Impedance(ImpedanceLaw::LinkSpring)));
        IMPEDANCE_OVER_RIVAL.check(ours / rival);
    }
}

#[test]
fn a_soft_spring_on_a_large_joint_does_not_swing_in_the_doubt_about_its_flank() {
    let mut train = DriveTrainParameters { delay_periods: 1.0, ..DriveTrainParameters::ideal() };
    train.motor.torque_limit = 120.0;
    let mut trial = Trial::steps(&l1(), &train, 128).with_impedance(300.0, 3.0);
    trial.bench.duration = 4.0;
    let run = |contender| trial.run(contender).expect("the trial runs");
    let law = run(Contender::ImpedanceNoGap(ImpedanceLaw::LinkSpring));
    SOFT_SPRING_SWING.check(deviation(&run(NO_PREVIEW), &law, trial.from).0);
}

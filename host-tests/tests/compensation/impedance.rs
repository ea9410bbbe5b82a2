//! Impedance mode: how far the link and its torque are from what the same law does on teeth without backlash.

use host_tests::closed_loop::rivals::ImpedanceLaw;
use host_tests::closed_loop::{Contender, ImpedanceGains, Trial, deviation};
use host_tests::drive_train::DriveTrainParameters;
use host_tests::scenarios::q1;
use host_tests::tolerance::compensation::{IMPEDANCE_DEVIATION, IMPEDANCE_OVER_RIVAL, IMPEDANCE_TORQUE};

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
        // Spring and damper alone: with the step's own torque sent along, the motor is at its limit.
        trial.bench.impedance = trial.bench.impedance.map(|gains| ImpedanceGains { inertia: 0.0, ..gains });
        comes_near_the_law_without_a_gap(&trial);
    }
}

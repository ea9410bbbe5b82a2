//! The fixed fine steps that closed loops run on, against the adaptive ones.

use host_tests::tolerance::compensation::FIXED_STEPS;
use reference::drive_train::{DriveTrainParameters, Stepping};
use reference::scenarios::q1;
use scenario::trial::{Contender, Trial};

#[test]
fn fixed_steps_move_the_joint_as_adaptive_ones_do() {
    let mut trial = Trial::inertial(&q1(), &DriveTrainParameters::q1(), 131);
    trial.bench.duration = 1.5;
    let fixed = trial.run(Contender::MotorPid).expect("the trial runs");
    trial.bench.stepping = Stepping::Adaptive;
    let adaptive = trial.run(Contender::MotorPid).expect("the trial runs");
    let difference = fixed.samples.iter().zip(&adaptive.samples).map(|(a, b)| (a.link - b.link).abs());
    FIXED_STEPS.check(difference.fold(0.0, f64::max) / 3.78e-3);
}

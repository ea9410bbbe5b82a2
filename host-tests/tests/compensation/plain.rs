//! Integral of plain control, which is in charge while the link is not observed.

use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::compensation::{Command, Compensation, Motion, Stage};
use model_core::observer::{Estimate, Estimates, OutputFault, Source};
use reference::drive_train::DriveTrainParameters;
use reference::scenarios::q1;

/// Largest torque of Q1's motor [N m].
const LIMIT: f32 = 2.5;

/// Motor speed at rest that makes its damper ask for the torque limit [rad/s].
const DAMPER_LIMIT_SPEED: f32 = 10.0;

/// Estimates of a joint whose link is not observed, with the motor at its set-point and at some speed [rad/s].
fn estimates(motor_speed: f32) -> Estimates<f32> {
    let mut estimates = Estimates {
        source: Source::MotorOnly(OutputFault::Silent),
        load_torque: Estimate { value: 0.0, variance: 0.0, valid: true },
        ..Estimates::default()
    };
    estimates.motor.speed = motor_speed;
    estimates
}

/// Torque at rest [N m] after a number of disturbances of the motor to either side, three times as fast to one side as to the other.
fn torque_after_disturbances(disturbances: usize) -> f32 {
    let tables =
        design_compensation::<f32>(&q1(), &compensation_settings(&DriveTrainParameters::q1().surroundings, 60.0))
            .expect("sound");
    let mut compensation = Compensation::new(&tables);
    let rest = Command::Position { now: Motion::default(), ahead: None };
    let mut step = |motor_speed| {
        let output = compensation.step(&estimates(motor_speed), &rest);
        assert_eq!(output.stage, Stage::Plain);
        output.torque
    };
    for disturbance in 0..disturbances {
        let (speed, side) =
            if disturbance % 2 == 0 { (DAMPER_LIMIT_SPEED, -1.0) } else { (-3.0 * DAMPER_LIMIT_SPEED, 1.0) };
        let torques = [(); 20].map(|()| step(speed));
        assert!(torques.iter().all(|torque| torque * side > 0.9 * LIMIT), "to the limit: {torques:?}");
    }
    [(); 5].map(|()| step(0.0))[4]
}

/// Torque cut off by the limit during an oscillation does not wind up the integral.
#[test]
fn limited_oscillation_does_not_wind_up() {
    // Torque cut off before the oscillation is detected does count.
    let [few, many] = [2, 40].map(torque_after_disturbances);
    println!("{few} and {many} N m");
    assert!(few.abs() < 0.5 * LIMIT, "{few} N m");
    assert!((many - few).abs() < 0.01 * LIMIT, "{many} N m in place of {few}");
}

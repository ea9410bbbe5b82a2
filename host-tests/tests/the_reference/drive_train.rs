//! The drive train around the joint, effect by effect: each test adds one effect to an ideal train and checks a figure computed by hand.

use std::f64::consts::TAU;

use host_tests::tolerance::{DRIVE_TRAIN, DRIVE_TRAIN_PARTS, EFFICIENCY};
use parameters::{AbsoluteEncoder, Friction, JointParameters, Surroundings};
use reference::drive_train::{Disturbance, DriveTrain, DriveTrainParameters, ErrorPhases, Measurement};
use reference::joint::{RelativeState, Start};
use reference::scenarios::{l1, q1};

const RATIO: f64 = 6.0;

/// Inertia of all of Q1 referred to its link, moving as one body [kg m^2].
fn q1_inertia() -> f64 {
    let joint = q1();
    let sun = joint.rotor_inertia + 0.02 * joint.geometry.sun_base_radius.powi(2);
    let lever = joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos();
    // Planets move along the line of action with the carrier: three of 0.03 kg, and the carrier with its planets.
    let cosine = joint.geometry.working_pressure_angle.cos();
    let carrier = 0.15 + 3.0 * 0.05 / (cosine * cosine);
    RATIO * RATIO * sun + (3.0 * 0.03 + carrier) * lever * lever + joint.link_inertia
}

fn turning(rigid_speed: f64) -> Start {
    Start::Relative(RelativeState { rigid_speed, ..RelativeState::centred(3) })
}

fn train(joint: &JointParameters, start: &Start, parameters: DriveTrainParameters) -> DriveTrain {
    DriveTrain::new(joint, start, parameters, Vec::new(), 1).expect("a sound drive train")
}

/// Runs a number of control periods with a constant command.
fn advance_periods(train: &mut DriveTrain, command: f64, periods: u32) {
    for _ in 0..periods {
        train.advance(command).expect("it runs");
    }
}

/// Counts and link angles of a run through the gap and back with all effects of Q1.
fn q1_run(seed: u64, parts_per_period: u32) -> (Vec<Measurement>, Vec<f64>) {
    let parameters = DriveTrainParameters { parts_per_period, ..DriveTrainParameters::q1() };
    let disturbances = vec![Disturbance::Pulse { start: 0.03, duration: 0.01, torque: 1.5 }];
    let mut train = DriveTrain::new(&q1(), &turning(0.0), parameters, disturbances, seed).expect("Q1 is sound");
    let mut measured = Vec::new();
    let mut link = Vec::new();
    for period in 0..1000 {
        train.advance(if period / 250 % 2 == 0 { 0.6 } else { -0.6 }).expect("it runs");
        measured.push(train.measure());
        link.push(train.joint().link_angle);
    }
    (measured, link)
}

/// Equal seeds give equal runs, different seeds different runs.
#[test]
fn equal_seeds_give_equal_runs() {
    let (first, _) = q1_run(7, 10);
    assert_eq!(first, q1_run(7, 10).0);
    assert_ne!(first, q1_run(8, 10).0);
}

/// Ten integration steps per control period are enough.
#[test]
fn ten_steps_per_period_are_enough() {
    let (_, coarse) = q1_run(7, 10);
    let (_, fine) = q1_run(7, 40);
    let difference = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let travel = fine.iter().cloned().fold(f64::MIN, f64::max) - fine.iter().cloned().fold(f64::MAX, f64::min);
    DRIVE_TRAIN_PARTS.check(difference / travel);
}

/// Without effects the train only accelerates the joint.
#[test]
fn ideal_train_only_accelerates() {
    let mut train = train(&q1(), &turning(0.0), DriveTrainParameters::ideal());
    advance_periods(&mut train, 0.5, 1000);
    DRIVE_TRAIN.check(train.joint().rigid_speed / (0.5 * RATIO * 0.1 / q1_inertia()) - 1.0);
}

/// The current loop has a lag, a delay, a torque limit and a gain error.
#[test]
fn current_loop_lags_delays_and_limits() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.current_lag = 0.2e-3;
    parameters.surroundings.torque_limit = 2.0;
    parameters.surroundings.torque_constant_error_ratio = 0.03;
    parameters.surroundings.delay = 1.0;
    let mut train = train(&q1(), &turning(0.0), parameters);
    advance_periods(&mut train, 5.0, 1);
    assert_eq!(train.torques().air_gap, 0.0, "the command is on its way for one period");
    advance_periods(&mut train, 5.0, 2);
    // The last step holds the mean over its length, which is the value at its middle for steps short against the lag.
    let middle = 0.2e-3 - 0.5 * 10e-6;
    let expected = 2.0 * 1.03 * (1.0 - (-middle / 0.2e-3_f64).exp());
    assert!((train.torques().air_gap / expected - 1.0).abs() < 2e-4, "{} N m", train.torques().air_gap);
    advance_periods(&mut train, 5.0, 100);
    DRIVE_TRAIN.check(train.torques().air_gap / (2.0 * 1.03) - 1.0);
}

/// Torque noise has the configured standard deviation.
#[test]
fn torque_noise_has_its_deviation() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.torque_noise_ratio = 0.015;
    parameters.parts_per_period = 1;
    let mut train = train(&l1(), &turning(0.0), parameters);
    let mut squares = 0.0;
    for _ in 0..2000 {
        train.advance(2.0).expect("it runs");
        squares += (train.torques().air_gap / 2.0 - 1.0).powi(2);
    }
    let ratio = (squares / 2000.0).sqrt();
    // The scatter of this estimate is 1/sqrt(4000) = 1.6 %.
    assert!((ratio / 0.015 - 1.0).abs() < 0.06, "{ratio}");
}

/// Dry friction holds a smaller torque and is subtracted from a larger one.
#[test]
fn dry_friction_holds_smaller_torques() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.motor_friction.coulomb = 0.03;
    let mut held = train(&q1(), &turning(0.0), parameters.clone());
    advance_periods(&mut held, 0.029, 500);
    DRIVE_TRAIN.check(held.joint().motor_speed);
    // The joint turns fast enough that no bounce of the teeth reverses the motor.
    let mut moving = train(&q1(), &turning(2.0), parameters);
    advance_periods(&mut moving, 0.08, 1000);
    DRIVE_TRAIN.check((moving.joint().rigid_speed - 2.0) / (0.05 * RATIO * 0.1 / q1_inertia()) - 1.0);
}

/// A turning joint coasts to rest and stays at rest.
#[test]
fn turning_joint_coasts_to_rest() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.load_friction = Friction { coulomb: 0.3, ..Friction::default() };
    let mut train = train(&q1(), &turning(0.3), parameters);
    advance_periods(&mut train, 0.0, 500);
    DRIVE_TRAIN.check(train.joint().rigid_speed / (0.3 - 0.3 * 0.05 / q1_inertia()) - 1.0);
    advance_periods(&mut train, 0.0, 3000);
    assert!(train.joint().link_speed.abs() < 1e-9, "{} rad/s", train.joint().link_speed);
}

/// Break-away torque exceeds dry friction by the Stribeck rise.
#[test]
fn break_away_exceeds_dry_friction() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.load_friction =
        Friction { coulomb: 0.3, stribeck_rise_ratio: 0.2, stribeck_speed: 0.05, viscous: 0.0 };
    for (torque, moves) in [(0.35, false), (0.37, true)] {
        let push = vec![Disturbance::Step { start: 0.0, torque }];
        let mut train = DriveTrain::new(&q1(), &turning(0.0), parameters.clone(), push, 1).expect("sound");
        advance_periods(&mut train, 0.0, 300);
        assert_eq!(train.joint().link_speed < -1e-3, moves, "{torque} N m: {} rad/s", train.joint().link_speed);
    }
}

/// Gravity returns the link to zero after half a period of the pendulum.
#[test]
fn gravity_returns_the_link_to_zero() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.gravity_torque = 6.0;
    // A pendulum at small angles: the link swings out with its speed and returns after half a period.
    let mut train = train(&q1(), &turning(0.05), parameters);
    let half_period = 0.5 * TAU * (q1_inertia() / 6.0).sqrt();
    advance_periods(&mut train, 0.0, (0.5 * half_period * 10e3).round() as u32);
    assert!(train.joint().link_angle > 0.0 && train.torques().gravity > 0.0);
    advance_periods(&mut train, 0.0, (0.5 * half_period * 10e3).round() as u32);
    // The teeth drift freely within 4b, 3.8 mrad at the output.
    assert!(train.joint().link_angle.abs() < 4e-3, "{} rad", train.joint().link_angle);
}

/// Efficiency is output over input power while the motor drives, and the inverse while the load drives.
#[test]
fn efficiency_is_output_over_input() {
    for (command, speed, load) in [(1.0, 2.0, RATIO * 0.97), (1.0, -2.0, RATIO / 0.97)] {
        let parameters = Surroundings { efficiency: 0.97, ..Surroundings::ideal() }.into();
        let brake = vec![Disturbance::Step { start: 0.0, torque: load }];
        // Forwards the motor drives a load of 97 %; backwards the load drives the motor, which receives 97 %.
        let mut joint = q1();
        // Far more damping than Q1's, so that the wind-up settles soon.
        joint.compliance.as_mut().expect("Q1 is compliant").damping_ratio = 2.0;
        let mut train = DriveTrain::new(&joint, &turning(speed), parameters, brake, 1).expect("sound");
        advance_periods(&mut train, command, 1000);
        let settled = train.joint().rigid_speed;
        advance_periods(&mut train, command, 1000);
        let acceleration = (train.joint().rigid_speed - settled) / 0.1;
        // Error of the efficiency that would cause this acceleration.
        EFFICIENCY.check(acceleration / (RATIO / q1_inertia()));
    }
}

/// An encoder reads the delayed angle with its errors, to one count.
#[test]
fn encoder_reads_delayed_angle_with_errors() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.output_encoder = AbsoluteEncoder {
        once_per_turn_error: 2e-3,
        twice_per_turn_error: 1e-3,
        skew: 73e-6,
        ..AbsoluteEncoder::ideal(20)
    };
    parameters.output_error_phases = ErrorPhases { once_per_turn: 0.4, twice_per_turn: 1.1 };
    let mut train = train(&q1(), &turning(30.0), parameters);
    let per_count = TAU / f64::from(1 << 20);
    for _ in 0..3000 {
        train.advance(0.0).expect("it runs");
        let joint = train.joint();
        let angle = joint.link_angle - 73e-6 * joint.link_speed;
        let expected = angle + 2e-3 * (angle + 0.4).sin() + 1e-3 * (2.0 * angle + 1.1).sin();
        let read = train.measure().output_counts as f64 * per_count;
        assert!((expected - read - 0.5 * per_count).abs() < 0.51 * per_count, "{expected} rad read as {read}");
        let motor = train.measure().motor_counts as f64 * TAU / f64::from(1 << 18);
        assert!((0.0..=TAU / f64::from(1 << 18)).contains(&(joint.motor_angle - motor)));
    }
    assert!(train.joint().link_angle > TAU, "whole turns are counted");
}

/// Cogging depends on the motor angle alone.
#[test]
fn cogging_follows_the_motor_angle() {
    let mut parameters = DriveTrainParameters::ideal();
    parameters.surroundings.cogging_torque = 0.02;
    parameters.surroundings.cogging_periods_per_turn = 84;
    let mut train = train(&q1(), &turning(1.0), parameters);
    for _ in 0..200 {
        let before = train.joint().motor_angle;
        let speed = train.joint().motor_speed;
        train.advance(0.0).expect("it runs");
        // The last of ten integration steps lies between both angles.
        let last_part = before + speed * 95e-6;
        assert!((train.torques().cogging - 0.02 * (84.0 * last_part).sin()).abs() < 2e-4);
    }
}

/// Drive train parameters out of range are rejected with their limits.
#[test]
fn parameters_out_of_range_are_rejected() {
    let refusal = |change: fn(&mut DriveTrainParameters)| {
        let mut parameters = DriveTrainParameters::q1();
        change(&mut parameters);
        DriveTrain::new(&q1(), &Start::Still, parameters, Vec::new(), 0).expect_err("must be refused").to_string()
    };
    assert_eq!(
        refusal(|train| train.surroundings.efficiency = 1.2),
        "efficiency is 1.2; it must be above 0 and at most 1"
    );
    assert_eq!(
        refusal(|train| train.surroundings.output_encoder.counts_per_turn = 1),
        "counts in a turn of an encoder is 1; it must be from 2 to 2^30"
    );
}

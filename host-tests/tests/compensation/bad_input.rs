//! Compensation with estimates and set-points that are missing, not finite, or absurd.

use model_core::compensation::design::{CompensationSettings, compensation_settings, design_compensation};
use model_core::compensation::{Command, Compensation, ImpedancePoint, Motion, Stage};
use model_core::observer::{Estimate, Estimates, OutputFault, Source};
use reference::drive_train::DriveTrainParameters;
use reference::scenarios::q1;

const LIMIT: f32 = 2.5;

fn sound() -> Estimates<f32> {
    let known = |value| Estimate { value, variance: 0.0, valid: true };
    Estimates {
        source: Source::Both,
        gap: known(80e-6),
        contact_valid: true,
        half_backlash: known(40e-6),
        half_backlash_usable: true,
        load_torque: known(0.3),
        ..Estimates::default()
    }
}

fn at_rest() -> Command<f32> {
    Command::Position { now: Motion::default(), ahead: None }
}

/// Torque stays within the limit for any non-finite or huge input, and full trust returns afterwards.
#[test]
fn bad_input_keeps_torque_within_limit() {
    let tables =
        design_compensation::<f32>(&q1(), &compensation_settings(&DriveTrainParameters::q1().surroundings, 60.0))
            .expect("sound");
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e30] {
        let mut estimates = [sound(); 9];
        estimates[0].gap.value = bad;
        estimates[1].half_backlash.value = bad;
        estimates[2].load_torque.value = bad;
        estimates[3].motor.speed = bad;
        estimates[4].link.speed = bad;
        estimates[5].link.fraction = bad;
        estimates[6].encoder_offset.value = bad;
        estimates[7].mesh_torque.value = bad;
        estimates[8].compliance.value = bad;
        let motion = Motion { acceleration: bad, speed: bad, ..Motion::default() };
        let commands = [
            at_rest(),
            Command::Position { now: motion, ahead: None },
            Command::Position { now: Motion::default(), ahead: Some(motion) },
            Command::Impedance(ImpedancePoint { stiffness: bad, ..ImpedancePoint::default() }),
        ];
        for estimates in &estimates {
            for command in &commands {
                let mut compensation = Compensation::new(&tables);
                for _ in 0..300 {
                    compensation.step(&sound(), &at_rest());
                }
                for _ in 0..300 {
                    let torque = compensation.step(estimates, command).torque;
                    assert!(torque.abs() <= LIMIT * 1.0001, "{torque} N m from {estimates:?} and {command:?}");
                }
                for _ in 0..3000 {
                    compensation.step(&sound(), &at_rest());
                }
                let after = compensation.step(&sound(), &at_rest());
                assert!(after.trust == 1.0 && after.load.iter().all(|load| load.is_finite()), "it does not recover");
            }
        }
    }
}

/// Without a valid gap the compensation hands over to plain control.
#[test]
fn invalid_gap_leaves_plain_control() {
    let tables =
        design_compensation::<f32>(&q1(), &compensation_settings(&DriveTrainParameters::q1().surroundings, 60.0))
            .expect("sound");
    let mut compensation = Compensation::new(&tables);
    for _ in 0..1000 {
        compensation.step(&sound(), &at_rest());
    }
    assert_ne!(compensation.step(&sound(), &at_rest()).stage, Stage::Plain);
    let blind = Estimates { source: Source::MotorOnly(OutputFault::Frozen), ..sound() };
    for _ in 0..1000 {
        compensation.step(&blind, &at_rest());
    }
    let shaped = compensation.step(&blind, &at_rest());
    assert_eq!((shaped.stage, shaped.trust), (Stage::Plain, 0.0));
}

/// A setting that allows no gain is rejected with an error that names it.
#[test]
fn unsound_settings_are_rejected_by_name() {
    let refusal = |change: fn(&mut CompensationSettings)| {
        let mut settings = compensation_settings(&DriveTrainParameters::q1().surroundings, 60.0);
        change(&mut settings);
        design_compensation::<f32>(&q1(), &settings).expect_err("must be refused").to_string()
    };
    assert!(refusal(|settings| settings.bandwidth = 0.0).contains("bandwidth"));
    assert!(refusal(|settings| settings.torque_limit = f64::NAN).contains("torque limit"));
    assert!(refusal(|settings| settings.peak_torque = Some(-1.0)).contains("peak torque"));
    assert!(refusal(|settings| settings.efficiency = 0.0).contains("efficiency"));
}

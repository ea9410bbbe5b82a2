//! Each fault by itself, against values computed by hand.

use std::f64::consts::TAU;

use reference::closed_loop::Motion;

use super::*;
use crate::case::Case;
use crate::file;
use crate::plant::{PlantName, plant};

fn host_faults(faults: &str) -> (HostFaults, Case) {
    let file = file::read(&format!("profile = \"T2\"\n{faults}")).expect("a good file");
    let case = Case::new(&file, joint_file::preset("q1").expect("a preset"), 1, None).expect("a case");
    (HostFaults::new(&file.faults, 1, &case.truth.parameters, &case.train), case)
}

/// Readings of the output encoder in a number of periods, while the true counts rise by `step` a period.
fn counts(faults: &str, periods: u64, step: i64) -> Vec<Option<TimedReading>> {
    let (mut faults, _) = host_faults(faults);
    (0..periods)
        .map(|period| {
            let output_counts = 1234 + step * period as i64;
            faults.sense(&Measurement { period, motor_counts: 0, output_counts }).output
        })
        .collect()
}

fn plain(faults: &str, periods: u64, step: i64) -> Vec<i64> {
    counts(faults, periods, step).into_iter().map(|frame| frame.expect("it came").counts).collect()
}

#[test]
fn frozen_encoder_holds_then_recovers() {
    let read = plain("[[fault]]\nkind = \"encoder_frozen\"\nstart_s = 0.001\nend_s = 0.002", 30, 7);
    assert_eq!((read[9], read[10], read[19], read[20]), (63, 70, 70, 140));
}

#[test]
fn offset_missing_counts_eccentric_values() {
    let read = plain("[[fault]]\nkind = \"encoder_offset\"\ncounts = 5\nstart_s = 0.001", 20, 0);
    assert_eq!((read[9], read[10]), (0, 5));
    let read = plain("[[fault]]\nkind = \"encoder_missing_counts\"\nshare = 0.1\nend_s = 0.01", 201, 10);
    assert_eq!((read[100], read[200]), (901, 1901), "what was not counted stays uncounted");
    // A quarter turn of 17 bits, an error of 0.1 degrees.
    let read = plain("[[fault]]\nkind = \"encoder_eccentric\"\nerror_deg = 0.1", 2, 32_768);
    assert_eq!(read[1] - 32_768, (0.1 / 360.0 * 131_072.0_f64).round() as i64);
}

#[test]
fn noise_has_stated_deviation() {
    let read = plain("[[fault]]\nkind = \"encoder_noise\"\nnoise_counts = 4", 20_000, 0);
    let deviation = (read.iter().map(|counts| (counts * counts) as f64).sum::<f64>() / 20_000.0).sqrt();
    assert!((deviation / 4.0 - 1.0).abs() < 0.03, "{deviation}");
}

#[test]
fn lost_share_and_late_frame_times() {
    let lost = counts("[[fault]]\nkind = \"lost_frames\"\nshare = 0.2", 20_000, 1);
    let share = lost.iter().filter(|frame| frame.is_none()).count() as f64 / 20_000.0;
    assert!((share - 0.2).abs() < 0.01, "{share}");
    let late = counts("[[fault]]\nkind = \"late_frames\"\ndelay_ms = 0.5\nstart_s = 0.001", 30, 3);
    assert_eq!(late[9], Some(TimedReading { counts: 27, period: 9, lateness: 0 }));
    assert_eq!(late[20], Some(TimedReading { counts: 45, period: 15, lateness: 0 }));
    assert_eq!(late[10..15], [None; 5], "a reading that came does not come again");
    assert_eq!(late[15], Some(TimedReading { counts: 30, period: 10, lateness: 0 }));
}

#[test]
fn late_period_stamped_with_lateness() {
    let (mut faults, _) = host_faults("");
    let seen = faults.sense_late(&Measurement { period: 7, motor_counts: 0, output_counts: 0 }, 4.2e-6);
    assert_eq!((seen.lateness, seen.motor.lateness, seen.output.map(|frame| frame.lateness)), (42, 42, Some(42)));
}

#[test]
fn missing_frames_independent_per_encoder() {
    let keys = "plant.motor_encoder.missing_frames_share = 0.05\nplant.output_encoder.missing_frames_share = 0.01";
    let missing = |keys: &str| {
        let (mut faults, _) = host_faults(keys);
        let mut missing = [0.0; 2];
        let mut periods = Vec::new();
        for period in 0..40_000 {
            let seen = faults.sense(&Measurement { period, motor_counts: 0, output_counts: 0 });
            missing[0] += f64::from(u8::from(seen.motor.period != period));
            missing[1] += f64::from(u8::from(seen.output.is_none()));
            if seen.output.is_none() {
                periods.push(period);
            }
        }
        (missing.map(|count| count / 40_000.0), periods)
    };
    let ([motor, output], periods) = missing(keys);
    // Four standard deviations of the shares.
    assert!((motor - 0.05).abs() < 0.0044 && (output - 0.01).abs() < 0.002, "{motor} and {output}");
    let (_, alone) = missing("plant.output_encoder.missing_frames_share = 0.01");
    assert_eq!(periods, alone, "the motor's missing readings leave the output's as they were");
    assert_eq!(missing("").0, [0.0; 2]);
}

#[test]
fn lost_set_point_keeps_previous() {
    let fault = "[[fault]]\nkind = \"lost_frames\"\nframes = \"set_points\"\nshare = 1\nstart_s = 0.001\nend_s = 0.002";
    let (mut faults, _) = host_faults(fault);
    let at = |position: f64| SetPoint::Position { now: Motion { position, ..Motion::default() }, ahead: None };
    let received: Vec<f64> =
        (0..30).map(|k| faults.receive(1e-4 * f64::from(k), k as u64, at(f64::from(k))).motion().position).collect();
    assert_eq!((received[9], received[10], received[19], received[20]), (9.0, 9.0, 9.0, 20.0));
}

#[test]
fn late_set_point_keeps_previous() {
    let fault = "[[fault]]\nkind = \"late_frames\"\nframes = \"set_points\"\ndelay_ms = 0.5\nstart_s = 0.001";
    let (mut faults, _) = host_faults(fault);
    let at = |position: f64| SetPoint::Position { now: Motion { position, ..Motion::default() }, ahead: None };
    let received: Vec<f64> =
        (0..30).map(|k| faults.receive(1e-4 * f64::from(k), k as u64, at(f64::from(k))).motion().position).collect();
    assert_eq!((received[9], received[10], received[14], received[15]), (9.0, 9.0, 9.0, 10.0));
}

#[test]
fn torque_bias_and_saturation_values() {
    let (faults, _) = host_faults(
        "[[fault]]\nkind = \"torque_bias\"\nratio = 0.05\ntorque_N_m = 0.1\n\
         [[fault]]\nkind = \"torque_saturation\"\ntorque_N_m = 1.5\nstart_s = 1",
    );
    assert!((faults.torque(0.5, 2.0) - 2.2).abs() < 1e-12);
    assert_eq!(faults.torque(1.5, -3.0), -1.5);
}

#[test]
fn tooth_faults_begin_and_end() {
    let fault = "[[fault]]\nkind = \"grown_backlash\"\nhalf_backlash_um = 90\nstart_s = 1\nend_s = 2\n\
                 [[fault]]\nkind = \"broken_tooth\"\nstiffness_ratio = 0.5";
    let (mut faults, case) = host_faults(fault);
    let mut plant = plant(PlantName::Reference, &case.truth.parameters, &case.train, Vec::new(), 1).expect("a plant");
    let mut joint = plant.joint().clone();
    faults.update_teeth(0.5, &joint, plant.joint_model().as_mut());
    assert_eq!(faults.current_half_backlash(), 40e-6);
    assert_eq!(faults.teeth.soft, [true, false, false], "the broken tooth starts at planet 0");
    faults.update_teeth(1.5, &joint, plant.joint_model().as_mut());
    assert!((faults.current_half_backlash() - 90e-6).abs() < 1e-18);
    // A third of a turn of the sun against the carrier later the tooth meets the next planet.
    joint.motor_angle = joint.carrier_angle + TAU / 3.0 + 0.01;
    faults.update_teeth(2.5, &joint, plant.joint_model().as_mut());
    assert_eq!(faults.current_half_backlash(), 40e-6);
    assert_eq!(faults.teeth.soft, [false, true, false]);
}

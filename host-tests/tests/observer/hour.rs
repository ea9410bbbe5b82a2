//! An hour of motion on the core's own joint, with several joints, motions and seeds: no healthy output encoder is excluded. Ignored by
//! default because it takes minutes.

use std::f64::consts::TAU;

use model_core::gears::design::design;
use model_core::virtual_joint::design::design_surroundings;

use model_core::observer::{MAPPED, Observer, Source};
use model_core::virtual_joint::VirtualJoint;

use crate::experiment::{Encoders, Experiment};
use crate::motion::{MotorController, uniform};

/// Duration of each joint's motion [s].
const MOTION_SECONDS: u32 = 240;

/// Periods until both encoders have been read.
const FIRST_CHECKED_PERIOD: u64 = 10;

/// No healthy output encoder is excluded in an hour of motion.
#[test]
#[ignore = "takes minutes: cargo test --release -p host-tests --test observer hour -- --ignored --nocapture"]
fn hour_excludes_no_healthy_encoder() {
    let mut seconds = 0;
    let mut alarms = 0;
    for (index, name) in ["q1", "d2", "l1"].into_iter().enumerate() {
        for (place, motion) in ["slow", "inertia", "gravity", "random", "hold"].into_iter().enumerate() {
            let seed = 800 + (5 * index + place) as u64;
            alarms += exclusions(name, motion, seed);
            seconds += MOTION_SECONDS;
        }
    }
    assert_eq!(seconds, 3600);
    assert_eq!(alarms, 0, "false alarms");
}

/// Number of exclusions of the output encoder. In the hold the load torque swings; the torque noise is the test's own.
fn exclusions(name: &str, motion: &str, seed: u64) -> usize {
    let experiment = Experiment::new(name, motion, Encoders::Preset, None, seed);
    let (joint, train) = (&experiment.setup.joint, &experiment.setup.train);
    let rate = train.surroundings.control_rate;
    let gears = design::<f32, 3>(joint, rate).expect("tables of the gears");
    let around = design_surroundings::<f32, 3>(joint, &train.surroundings, &gears).expect("surroundings");
    let mut plant = VirtualJoint::new(&gears, &around);
    let observer = experiment.tables::<f32>();
    let mut observer = Observer::<f32, MAPPED>::new(&observer);
    let mut controller = MotorController::new(joint, train);
    let mut uniform = uniform(seed);
    let turn = train.surroundings.motor_encoder.counts_per_turn as i64;
    let (mut counts, mut alarms, mut seen, mut commanded) = (0_i64, 0, false, 0.0);
    for period in 0..u64::from(MOTION_SECONDS * rate) {
        let time = period as f64 * controller.period;
        let mut samples = plant.samples();
        samples.torque = commanded;
        let by = (i64::from(samples.motor.counts) - counts).rem_euclid(turn);
        counts += if by > turn / 2 { by - turn } else { by };
        let published = observer.step(&samples);
        if period > FIRST_CHECKED_PERIOD && published.source != Source::Both {
            alarms += usize::from(seen);
        }
        seen = published.source == Source::Both;
        let command = controller.step(counts, experiment.setup.motion.at(time));
        commanded = command as f32;
        let noise = 1.0 + train.surroundings.torque_noise_ratio * 3.46 * (uniform() - 0.5);
        let pushed = if motion == "hold" { 0.125 * joint.rated_output_torque * (0.7 * TAU * time).sin() } else { 0.0 };
        plant.advance((command * noise) as f32, pushed as f32);
    }
    let published = observer.estimates();
    let width = f64::from(published.half_backlash.value) / joint.sun_planet.half_backlash[0] - 1.0;
    println!("{name}, {motion}, seed {seed}: excluded {alarms} times; half-backlash wrong by {width:.4} at the end");
    alarms
}

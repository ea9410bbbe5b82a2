//! Gap, contact, torques and width with both encoders: errors against their bounds on a few joints, widths and motions.

use host_tests::extent::cases;
use host_tests::tolerance::observer::*;
use model_core::observer::{Estimate, MAPPED, PLAIN};
use reference::drive_train::Disturbance;

use crate::experiment::{Encoders, Experiment};
use crate::motion::growing;
use crate::recording::PeriodSample;
use crate::replay::{ObserverErrors, with_encoders};

/// Seeds and half-backlash of the experiments [m]; the short form has the extreme widths.
const WIDTHS: [(u64, f64); 3] = [(1, 20e-6), (3, 80e-6), (2, 40e-6)];
const SHORT_WIDTHS: usize = 2;

/// Errors of an experiment on Q1 with error maps, from 2 s on.
fn figures(motion: &str, encoders: Encoders, half_backlash: f64, seed: u64) -> ObserverErrors {
    let experiment = Experiment::new("q1", motion, encoders, Some(half_backlash), seed).lasting(4.5);
    experiment.figures(&experiment.record(), 2.0)
}

/// Ideal encoders of 18 bits.
#[test]
fn ideal_encoders_locate_the_gap() {
    for &(seed, half_backlash) in cases(&WIDTHS, SHORT_WIDTHS) {
        let experiment = Experiment::new("q1", "inertia", Encoders::Ideal, Some(half_backlash), seed).lasting(4.0);
        let figures = experiment.replay::<PLAIN>(&experiment.record(), 1.5, |_, _, _| {});
        GAP_IDEAL.check(figures.gap);
        CONTACT_WRONG.check(1.0 - figures.contact);
    }
}

/// The preset's encoders.
#[test]
fn preset_encoders_meet_all_bounds() {
    let mut all = ObserverErrors::default();
    for &(seed, half_backlash) in cases(&WIDTHS, SHORT_WIDTHS) {
        for motion in ["inertia", "random"] {
            println!("{motion}, seed {seed}, half-backlash {half_backlash} m");
            let figures = figures(motion, Encoders::Preset, half_backlash, seed);
            GAP_COARSE.check(figures.gap);
            GAP_WORST.check(figures.gap_worst);
            CONTACT_WRONG.check(1.0 - figures.contact);
            assert_eq!(figures.missed, 0, "a landing was missed");
            LOAD_TORQUE.check(figures.load_torque);
            MESH_TORQUE.check(figures.mesh_torque);
            WIDTH.check(figures.width);
            WIDTH_TIME.check(figures.width_after);
            all = all.worse(&figures);
        }
    }
    LANDING_DELAY.check(all.delay(0.5));
    LANDING_DELAY_LONG.check(all.delay(0.95));
}

/// Finer encoders, and a slow motion against friction.
#[test]
fn fine_encoders_and_slow_motion() {
    GAP_FINE.check(figures("gravity", Encoders::Bits(16, 18), 40e-6, 4).gap);
    let slow = Experiment::new("q1", "slow", Encoders::Preset, Some(40e-6), 5).lasting(6.0);
    let figures = slow.figures(&slow.record(), 2.0);
    GAP_COARSE.check(figures.gap);
    WIDTH.check(figures.width);
}

/// A two-stage joint and a stiff joint.
#[test]
fn other_joints_meet_the_bounds() {
    for (name, seed) in [("d2", 6), ("l1", 7)] {
        let experiment = Experiment::new(name, "gravity", Encoders::Preset, None, seed).lasting(3.0);
        let figures = experiment.figures(&experiment.record(), 2.0);
        println!("{name}: {figures:?}");
        GAP_COARSE.check(figures.gap);
        WIDTH.check(figures.width);
        assert_eq!(figures.missed, 0, "{name} missed a landing");
    }
}

/// Error maps reduce the gap's error, and keep doing so when the range of motion grows.
#[test]
fn error_maps_reduce_the_gap_error() {
    // A fifth of the amplitude at first, all of it later.
    let mut experiment = Experiment::new("q1", "inertia", Encoders::Preset, Some(40e-6), 8).lasting(5.0);
    experiment.setup.motion = growing(experiment.setup.motion, 2.5);
    let log = experiment.record();
    GAP_COARSE.check(experiment.figures(&log, 2.4).gap);
    let plain = experiment.replay::<PLAIN>(&log, 1.5, |_, _, _| {});
    GAP_WITH_MAP_OVER_WITHOUT.check(experiment.figures(&log, 1.5).gap / plain.gap);
}

/// An encoder harmonic outside the map costs little.
#[test]
fn unmapped_harmonic_costs_little() {
    let experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), 9).lasting(4.0);
    let log = experiment.record();
    let clean = with_encoders(&log, &experiment.setup.train);
    let count = core::f64::consts::TAU / experiment.setup.train.surroundings.motor_encoder.counts_per_turn as f64;
    let mut dirty = clean.clone();
    for moment in &mut dirty {
        let error = 0.02_f64.to_radians() * (4.0 * moment.motor[0] + 1.0).sin();
        moment.motor_counts += (error / count).round() as i64;
    }
    FOURTH_HARMONIC.check(experiment.figures(&dirty, 2.0).gap - experiment.figures(&clean, 2.0).gap);
}

/// A link inertia wrong by 30 % is estimated from landings.
#[test]
fn wrong_inertia_is_learnt_from_landings() {
    let right = Experiment::new("q1", "inertia", Encoders::Preset, Some(40e-6), 10).lasting(4.0);
    let log = right.record();
    for wrong in [0.7, 1.3] {
        let mut experiment = right.clone();
        experiment.nominal.link_inertia *= wrong;
        let mut learnt = Estimate::default();
        let figures = experiment.replay::<MAPPED>(&log, 2.0, |_, _, estimates| learnt = estimates.link_inertia_ratio);
        GAP_COARSE.check(figures.gap);
        LOAD_TORQUE_WRONG_INERTIA.check(figures.load_torque);
        LINK_INERTIA.check((learnt.value * wrong - 1.0).abs());
        assert!(learnt.valid, "the estimate is valid");
    }
}

/// External pushes at irregular times do not change the estimated inertia.
#[test]
fn pushes_keep_the_inertia_estimate() {
    let mut experiment = Experiment::new("q1", "random", Encoders::Preset, Some(40e-6), 12).lasting(4.0);
    let rated = experiment.setup.joint.rated_output_torque;
    let push = |n: u32| Disturbance::Pulse {
        start: 0.3 + 0.31 * f64::from(n),
        duration: 0.1,
        torque: if n % 3 == 1 { -0.3 * rated } else { 0.3 * rated },
    };
    experiment.setup.disturbances = (0..12).map(push).collect();
    experiment.replay::<MAPPED>(&experiment.record(), 1.0, |_, _, estimates| {
        let learnt = estimates.link_inertia_ratio;
        assert!(!learnt.valid && (learnt.value - 1.0).abs() < 0.1, "{learnt:?}");
    });
}

/// A torque bias is measured inside the gap.
#[test]
fn torque_bias_is_measured_in_the_gap() {
    for part in [0.05, -0.05] {
        let experiment = Experiment::new("q1", "inertia", Encoders::Preset, Some(40e-6), 11).lasting(4.0);
        let mut log = experiment.record();
        let read = |log: &[PeriodSample]| {
            experiment.published::<f64>(log, |_, _| {}).last().map(|published| published.torque_bias)
        };
        let own = read(&log).expect("a recording");
        // A bias is torque lost by the motor, which gives less than its command.
        let bias = part * experiment.setup.train.surroundings.torque_limit;
        log.iter_mut().for_each(|moment| moment.command += bias);
        let found = read(&log).expect("a recording");
        assert!(own.valid && found.valid, "{own:?}, {found:?}");
        TORQUE_BIAS.check((found.value - own.value) / bias - 1.0);
        let figures = experiment.figures(&log, 2.0);
        GAP_WITH_BIAS.check(figures.gap);
        assert_eq!(figures.missed, 0, "a landing was missed");
    }
}

//! Encoder faults and implausible samples: they are detected and reported, errors stay bounded, and the observer recovers.

use std::sync::LazyLock;

use host_tests::extent::short_or_long;
use host_tests::tolerance::observer::{
    FAULT_DETECTION_TIME, FAULT_DETECTION_TIME_AT_SPEED, GAP_COARSE, LINK_ANGLE_AFTER_SLIP, LOST_COUNTS_DETECTION_TIME,
    ONE_WRONG_BIT, WIDTH_AFTER_LOST_COUNTS,
};
use model_core::observer::{Estimates, MAPPED, OutputFault, Samples, Source};
use reference::drive_train::Disturbance;

use crate::experiment::{Encoders, Experiment};
use crate::motion::{TestMotion, uniform};
use crate::recording::PeriodSample;
use crate::replay::samples;

/// Experiment on Q1 in continuous motion, and its recording.
fn turning() -> (Experiment, Vec<PeriodSample>) {
    static TURNING: LazyLock<(Experiment, Vec<PeriodSample>)> = LazyLock::new(|| {
        let experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), 21).lasting(4.0);
        let log = experiment.record();
        (experiment, log)
    });
    TURNING.clone()
}

/// First period from `from` seconds on in which the link turns faster than 1 rad/s.
fn first_fast_period(log: &[PeriodSample], from: f64) -> usize {
    first_period_above(log, from, 1.0)
}

/// First period from `from` seconds on in which the link exceeds a speed [rad/s].
fn first_period_above(log: &[PeriodSample], from: f64, speed: f64) -> usize {
    let first = (from * 10e3) as usize;
    first + log.iter().skip(first).position(|moment| moment.link[1].abs() > speed).expect("it turns")
}

/// Source of the estimates after every period.
fn sources(experiment: &Experiment, log: &[PeriodSample]) -> Vec<Source> {
    let source = |estimates: &Estimates<f64>| {
        assert!(estimates.gap.value.is_finite() && estimates.gap.variance.is_finite());
        estimates.source
    };
    experiment.published(log, |_, _| {}).iter().map(source).collect()
}

/// A frozen output encoder is excluded soon, and readmitted once it turns again.
#[test]
fn frozen_output_is_excluded_and_readmitted() {
    let (experiment, mut log) = turning();
    let at = first_fast_period(&log, 2.0);
    let counts = log[at].output_counts;
    log[at..at + 3000].iter_mut().for_each(|moment| moment.output_counts = counts);
    let sources = sources(&experiment, &log);
    assert!(sources[..at].iter().all(|source| *source == Source::Both), "a false alarm");
    let found = sources[at..].iter().position(|source| *source != Source::Both).expect("the fault is detected");
    FAULT_DETECTION_TIME.check(found as f64 * 1e-4);
    assert_eq!(sources[at + found], Source::MotorOnly(OutputFault::Frozen));
    assert_eq!(sources.last(), Some(&Source::Both), "it is readmitted");
}

/// At speed, an output encoder that freezes or jumps is excluded within a millisecond.
#[test]
fn output_fault_at_speed_is_excluded_in_1_ms() {
    for (name, seed) in [("q1", 22), ("d2", 23)] {
        let experiment = Experiment::new(name, "gravity", Encoders::Preset, None, seed).lasting(2.6);
        let healthy = experiment.record();
        for (speed, jump) in [(0.45, 0), (1.0, 0), (1.0, 40), (0.1, -400), (0.1, 30_000)] {
            let mut log = healthy.clone();
            let at = first_period_above(&log, 1.9, speed);
            let frozen = log[at].output_counts;
            log[at..].iter_mut().for_each(|moment| {
                moment.output_counts = if jump == 0 { frozen } else { moment.output_counts + jump };
            });
            let sources = sources(&experiment, &log);
            assert!(sources[10..at].iter().all(|source| *source == Source::Both), "a false alarm");
            let found = sources[at..].iter().position(|source| *source != Source::Both).expect("the fault is detected");
            println!("{name} at {speed} rad/s, jump of {jump} counts: after {found} periods");
            FAULT_DETECTION_TIME_AT_SPEED.check(found as f64 * 1e-4);
            let doubt = if jump == 0 { OutputFault::Frozen } else { OutputFault::OutOfRange };
            assert_eq!(sources[at + found], Source::MotorOnly(doubt));
        }
    }
}

/// Before the gap is known, the travel of the motor reveals a frozen output encoder.
#[test]
fn motor_travel_reveals_frozen_output() {
    // The transmission error of S1 hides its gap, and its link is light: its teeth may stop it at once from this speed.
    let mut experiment = Experiment::new("s1", "inertia", Encoders::Preset, None, 27).lasting(2.6);
    experiment.setup.motion = TestMotion::Sine(0.5, 1.0).motion(experiment.setup.seed);
    let mut log = experiment.record();
    let at = first_period_above(&log, 1.9, 0.5);
    let speed = |moment: &PeriodSample| moment.link[1].abs();
    let at = at + log[at..].iter().position(|moment| speed(moment) < 0.9).expect("it turns round");
    let counts = log[at].output_counts;
    log[at..].iter_mut().for_each(|moment| moment.output_counts = counts);
    let sources = sources(&experiment, &log);
    assert!(sources[10..at].iter().all(|source| *source == Source::Both), "a false alarm");
    let found = sources[at..].iter().position(|source| *source != Source::Both).expect("the fault is detected");
    println!("at {:.2} rad/s: after {found} periods", speed(&log[at]));
    FAULT_DETECTION_TIME.check(found as f64 * 1e-4);
    assert_eq!(sources[at + found], Source::MotorOnly(OutputFault::Frozen));
}

/// Noise, glitches, impacts, late or lost readings and 12-bit counts do not exclude the output encoder.
#[test]
fn disturbed_sound_output_is_kept() {
    let mut experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), 25).lasting(3.0);
    let rated = experiment.setup.joint.rated_output_torque;
    let blow = |start, torque| Disturbance::Pulse { start, duration: 10e-3, torque };
    experiment.setup.disturbances = vec![blow(1.2, 3.0 * rated), blow(1.55, -3.0 * rated), blow(2.3, 3.0 * rated)];
    let log = experiment.record();
    let mut noise = uniform(7);
    let mut normal = move || (0..4).map(|_| noise() - 0.5).sum::<f64>() * 3.0_f64.sqrt();
    let mut lost = uniform(8);
    let range = 1_u32 << 17;
    type Spoil<'a> = &'a mut dyn FnMut(usize, &mut Samples<f64>);
    let noisy: Spoil = &mut |_, samples| shift_output(samples, (3.0 * normal()).round() as i32, range);
    let glitches: Spoil = &mut |k, samples| shift_output(samples, if k % 777 == 5 { 64 } else { 0 }, range);
    let losing: Spoil = &mut |_, samples| samples.output = samples.output.filter(|_| lost() > 0.2);
    let late: Spoil = &mut |k, samples| {
        if k > 15_000 {
            samples.output = Some(self::samples(&experiment.settings, &log[k - 3], k - 3))
                .and_then(|late: Samples<f64>| late.output);
        }
    };
    for (name, spoil) in [("noise", noisy), ("glitches", glitches), ("lost", losing), ("late", late)] {
        let alarm =
            experiment.published(&log, spoil)[10..].iter().position(|estimates| estimates.source != Source::Both);
        assert_eq!(alarm, None, "a false alarm so many periods behind the tenth under {name}");
    }
    let coarse = Experiment::new("q1", "gravity", Encoders::Bits(14, 12), Some(40e-6), 25).lasting(3.0);
    let sources = sources(&coarse, &coarse.record());
    assert!(sources[10..].iter().all(|source| *source == Source::Both), "a false alarm with 12 bits");
}

/// Shifts the output's reading by some counts.
fn shift_output(samples: &mut Samples<f64>, by: i32, range: u32) {
    if let Some(output) = &mut samples.output {
        output.counts = output.counts.wrapping_add_signed(by) % range;
    }
}

/// An output encoder that slips is excluded.
#[test]
fn slipping_output_is_excluded() {
    let (experiment, mut log) = turning();
    let at = first_fast_period(&log, 2.0);
    log[at..].iter_mut().for_each(|moment| moment.output_counts += 400);
    let sources = sources(&experiment, &log);
    let found = sources[at..].iter().position(|source| *source != Source::Both).expect("the fault is detected");
    FAULT_DETECTION_TIME.check(found as f64 * 1e-4);
    assert_eq!(sources[at + found], Source::MotorOnly(OutputFault::OutOfRange));
}

/// Twenty seeds of encoder errors, on a motion with frequent reversals. The guess of the width is too small: with a guess too large, a slip
/// without an implausible reading passes for wear.
#[test]
#[ignore = "half a minute and more: .ci/attack"]
fn hidden_slip_is_not_taken_for_wear() {
    let experiment = |seed| Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), seed).lasting(2.4);
    let guessed = |of: &Experiment| of.nominal.sun_planet.half_backlash[0] < 40e-6;
    for (seed, experiment) in (24..).map(|seed| (seed, experiment(seed))).filter(|(_, of)| guessed(of)).take(20) {
        let log = experiment.record();
        let healthy = experiment.published::<f64>(&log, |_, _| {});
        let modified = experiment
            .published::<f64>(&log, |k, samples| shift_output(samples, if k % 777 == 5 { 64 } else { 0 }, 1 << 17));
        let moved = healthy.iter().zip(&modified).skip(18_000);
        let worst = moved.map(|(a, b)| (a.load_torque.value - b.load_torque.value).abs()).fold(0.0, f64::max);
        ONE_WRONG_BIT.check(worst / experiment.setup.joint.rated_output_torque);

        // Readings are missing during the slip, which goes away from the loaded flank: beyond the flank by a distance that wear can
        // explain.
        let carries = |from: usize| log[from].gap.abs() > 80e-6 && log[from].gap * log[from + 60].gap > 0.0;
        let at = (20_000..23_000).find(|from| carries(*from)).expect("a flank carries for some milliseconds");
        let slip = if log[at].gap > 0.0 { 30 } else { -30 };
        let slipping = experiment.published::<f64>(&log, |k, samples| {
            if k >= at {
                shift_output(samples, -slip, 1 << 17);
            }
            if at.abs_diff(k) < 2 {
                samples.output = None;
            }
        });
        let found = slipping[at..]
            .iter()
            .position(|estimates| estimates.source != Source::Both)
            .expect("the fault is detected");
        println!(
            "seed {seed}: {worst:.3} N m after one wrong bit; a slip of {slip} counts found after {found} periods"
        );
        FAULT_DETECTION_TIME.check(found as f64 * 1e-4);
    }
}

/// An output encoder that loses counts never makes the half-backlash negative.
#[test]
fn lost_counts_keep_half_backlash_positive() {
    let experiment = Experiment::new("q1", "inertia", Encoders::Preset, Some(40e-6), 902).lasting(2.5);
    let mut log = experiment.record();
    let start = log[15_000].output_counts;
    log[15_000..].iter_mut().for_each(|moment| {
        moment.output_counts -= (0.01 * (moment.output_counts - start) as f64).round() as i64;
    });
    let (mut least, mut found) = (f64::INFINITY, false);
    experiment.replay::<MAPPED>(&log, 1.0, |k, _, estimates| {
        least = least.min(estimates.half_backlash.value);
        found |= k > 15_000 && estimates.source != Source::Both;
    });
    assert!(least >= 0.0, "the half-backlash goes to {least} m");
    assert!(found, "the encoder is excluded");
}

/// An output encoder that makes the gap narrower is excluded, since wear only widens a gap.
#[test]
fn narrowing_output_is_excluded() {
    let experiment = Experiment::new("q1", "inertia", Encoders::Preset, Some(40e-6), 24).lasting(3.0);
    let mut log = experiment.record();
    let start = log[20_000].output_counts;
    log[20_000..].iter_mut().for_each(|moment| {
        moment.output_counts -= (0.003 * (moment.output_counts - start) as f64).round() as i64;
    });
    let sources = sources(&experiment, &log);
    let found = sources[20_000..].iter().position(|source| *source != Source::Both).expect("the fault is detected");
    LOST_COUNTS_DETECTION_TIME.check(found as f64 * 1e-4);
    assert!(sources[20_000 + found] == Source::MotorOnly(OutputFault::OutOfRange));
}

/// Counts of either direction are lost at random, so that the deflection drifts on both flanks.
#[test]
fn lost_counts_keep_the_known_width() {
    for seed in 27..short_or_long(28, 30) {
        let experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), seed).lasting(3.0);
        let mut log = experiment.record();
        let (mut any, mut lost, mut before) = (uniform(seed), 0, log[20_000].output_counts);
        for moment in &mut log[20_000..] {
            let by = moment.output_counts - core::mem::replace(&mut before, moment.output_counts);
            lost += by.signum() * (0..by.abs()).map(|_| i64::from(any() < 0.03)).sum::<i64>();
            moment.output_counts -= lost;
        }
        let published = experiment.published::<f64>(&log, |_, _| {});
        let found = published[20_000..].iter().position(|estimates| estimates.source != Source::Both);
        println!("seed {seed}: {lost} counts lost, excluded after {found:?} periods");
        assert!(found.is_some(), "the encoder is excluded");
        WIDTH_AFTER_LOST_COUNTS.check((published[29_999].half_backlash.value - 40e-6) / 40e-6);
    }
}

/// After the encoder's slip the link's angle is right again once the encoder is readmitted.
#[test]
fn link_angle_survives_encoder_slip() {
    let experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), 21).lasting(6.0);
    let log = experiment.record();
    let healthy = experiment.published::<f64>(&log, |_, _| {});
    let at = first_fast_period(&log, 2.0);
    for slip in [-3000, -400, 400, 3000] {
        let published = experiment
            .published::<f64>(&log, |k, samples| shift_output(samples, if k < at { 0 } else { slip }, 1 << 17));
        assert!(matches!(published[at + 100].source, Source::MotorOnly(_)), "it is excluded");
        let back =
            at + 100 + published[at + 100..].iter().position(|now| now.source == Source::Both).expect("readmitted");
        println!("a slip of {slip} counts is excluded, and readmitted after {} periods", back - at);
        let astray = published.iter().zip(&healthy).skip(back + 2000).map(|(published, healthy)| {
            let turns =
                f64::from(published.link.turns - healthy.link.turns) + published.link.fraction - healthy.link.fraction;
            turns.abs() * core::f64::consts::TAU
        });
        LINK_ANGLE_AFTER_SLIP.check(astray.fold(0.0, f64::max));
    }
}

/// Runs the observer with samples that a test modifies.
fn run_modified(spoil: impl Fn(usize, &mut Samples<f64>)) -> (Experiment, Vec<PeriodSample>, Vec<Estimates<f64>>) {
    let (experiment, log) = turning();
    let published = experiment.published(&log, spoil);
    (experiment, log, published)
}

/// RMS error of the gap over the last half second, over the gap.
fn late_error(log: &[PeriodSample], published: &[Estimates<f64>]) -> f64 {
    let late = log.len() - 5000..log.len();
    let sum: f64 = late.clone().map(|period| (published[period].gap.value - log[period].gap).powi(2)).sum();
    (sum / late.len() as f64).sqrt() / 160e-6
}

/// A silent output encoder is reported, and used again when it returns.
#[test]
fn silent_output_is_reported_and_readmitted() {
    let (_, log, published) = run_modified(|period, samples| {
        if (20_000..22_000).contains(&period) {
            samples.output = None;
        }
    });
    assert_eq!(published[21_999].source, Source::MotorOnly(OutputFault::Silent));
    assert_eq!(published.last().map(|estimates| estimates.source), Some(Source::Both));
    GAP_COARSE.check(late_error(&log, &published));
}

/// Implausible samples are reported and leave no lasting error.
#[test]
fn implausible_samples_are_reported() {
    let (_, log, published) = run_modified(|period, samples| match period {
        20_000 => samples.torque = f64::NAN,
        20_500 => samples.motor.counts ^= 1 << 13,
        21_000 => samples.time = samples.time.wrapping_sub(50_000),
        21_500 => samples.torque = f64::INFINITY,
        _ => {}
    });
    assert!(published[20_000].notices.torque_unknown && !published[20_001].notices.torque_unknown);
    assert!(published[20_500].notices.motor_implausible && !published[20_502].notices.motor_implausible);
    assert!(published[21_000].notices.out_of_time && !published[21_010].notices.out_of_time);
    assert!(published[21_500].notices.torque_unknown);
    GAP_COARSE.check(late_error(&log, &published));
}

/// A lasting jump of the motor encoder is reported; estimates stay finite.
#[test]
fn lasting_motor_jump_is_reported() {
    let (_, log, published) = run_modified(|period, samples| {
        if period >= 20_000 {
            samples.motor.counts = (samples.motor.counts + 4000) % (1 << 14);
        }
    });
    let jumped = published[20_000..20_010].iter().any(|estimates| estimates.notices.motor_jumped);
    assert!(jumped, "the jump is reported");
    assert!(published.iter().all(|estimates| estimates.gap.value.is_finite()));
    let late = late_error(&log, &published);
    println!("after the jump: {late}");
}

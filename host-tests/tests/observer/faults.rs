//! Encoders that fail and samples that make no sense: found, said, bounded, recovered from.

use host_tests::tolerance::observer::{FAILURE_FOUND, GAP_COARSE, LOST_COUNTS_FOUND};
use model_core::realtime::observer::{Doubt, Estimates, MAPPED, Observer, Samples, Source};

use crate::motion::Moment;
use crate::replay::{replay, samples};
use crate::trial::{Encoders, Trial};

/// A recording of Q1 that turns all the time, with its trial.
fn turning() -> (Trial, Vec<Moment>) {
    let trial = Trial::new("q1", "gravity", Encoders::Preset, Some(40e-6), 21).lasting(4.0);
    let log = trial.record();
    (trial, log)
}

/// First moment from `from` seconds on in which the link turns fast.
fn fast(log: &[Moment], from: f64) -> usize {
    (from * 10e3) as usize
        + log.iter().skip((from * 10e3) as usize).position(|moment| moment.link[1].abs() > 1.0).expect("it turns")
}

/// Source after every period.
fn sources(trial: &Trial, log: &[Moment]) -> Vec<Source> {
    let mut sources = Vec::new();
    replay::<f64, MAPPED>(&trial.run.joint, &trial.tables(), &trial.settings, log, 1.0, |_, _, estimates| {
        assert!(estimates.gap.value.is_finite() && estimates.gap.variance.is_finite());
        sources.push(estimates.source);
    });
    sources
}

#[test]
fn a_frozen_output_encoder_is_given_up_soon_and_taken_back_when_it_turns_again() {
    let (trial, mut log) = turning();
    let at = fast(&log, 2.0);
    let counts = log[at].output_counts;
    log[at..at + 3000].iter_mut().for_each(|moment| moment.output_counts = counts);
    let sources = sources(&trial, &log);
    assert!(sources[..at].iter().all(|source| *source == Source::Both), "a false alarm");
    let found = sources[at..].iter().position(|source| *source != Source::Both).expect("it is found");
    FAILURE_FOUND.check(found as f64 * 1e-4);
    assert_eq!(sources[at + found], Source::MotorOnly(Doubt::Frozen));
    assert_eq!(sources.last(), Some(&Source::Both), "it is taken back");
}

#[test]
fn an_output_encoder_that_slips_is_given_up() {
    let (trial, mut log) = turning();
    let at = fast(&log, 2.0);
    log[at..].iter_mut().for_each(|moment| moment.output_counts += 400);
    let sources = sources(&trial, &log);
    let found = sources[at..].iter().position(|source| *source != Source::Both).expect("it is found");
    FAILURE_FOUND.check(found as f64 * 1e-4);
    assert_eq!(sources[at + found], Source::MotorOnly(Doubt::OutOfRange));
}

#[test]
fn an_output_encoder_that_loses_counts_never_makes_a_width_less_than_none() {
    let trial = Trial::new("q1", "inertia", Encoders::Preset, Some(40e-6), 902).lasting(2.5);
    let mut log = trial.record();
    let start = log[15_000].output_counts;
    log[15_000..].iter_mut().for_each(|moment| {
        moment.output_counts -= (0.01 * (moment.output_counts - start) as f64).round() as i64;
    });
    let (mut least, mut found) = (f64::INFINITY, false);
    replay::<f64, MAPPED>(&trial.run.joint, &trial.tables(), &trial.settings, &log, 1.0, |k, _, estimates| {
        least = least.min(estimates.half_backlash.value);
        found |= k > 15_000 && estimates.source != Source::Both;
    });
    assert!(least >= 0.0, "the half-backlash goes to {least} m");
    assert!(found, "the encoder is given up");
}

#[test]
fn an_output_encoder_that_makes_the_gap_narrower_is_given_up_for_teeth_do_not_grow() {
    let trial = Trial::new("q1", "inertia", Encoders::Preset, Some(40e-6), 24).lasting(3.0);
    let mut log = trial.record();
    let start = log[20_000].output_counts;
    log[20_000..].iter_mut().for_each(|moment| {
        moment.output_counts -= (0.003 * (moment.output_counts - start) as f64).round() as i64;
    });
    let sources = sources(&trial, &log);
    let found = sources[20_000..].iter().position(|source| *source != Source::Both).expect("it is found");
    LOST_COUNTS_FOUND.check(found as f64 * 1e-4);
    assert!(sources[20_000 + found] == Source::MotorOnly(Doubt::OutOfRange));
}

/// Runs the observer with samples that a test may spoil.
fn spoilt(spoil: impl Fn(usize, &mut Samples<f64>)) -> (Trial, Vec<Moment>, Vec<Estimates<f64>>) {
    let (trial, log) = turning();
    let tables = trial.tables();
    let mut observer = Observer::<f64, MAPPED>::new(&tables);
    let said = log
        .iter()
        .enumerate()
        .map(|(period, moment)| {
            let mut samples = samples(&trial.settings, moment, period);
            spoil(period, &mut samples);
            *observer.step(&samples)
        })
        .collect();
    (trial, log, said)
}

/// Error of the gap over the last half second, over the gap.
fn late_error(log: &[Moment], said: &[Estimates<f64>]) -> f64 {
    let late = log.len() - 5000..log.len();
    let sum: f64 = late.clone().map(|period| (said[period].gap.value - log[period].gap).powi(2)).sum();
    (sum / late.len() as f64).sqrt() / 160e-6
}

#[test]
fn a_silent_output_encoder_is_said_and_waited_for() {
    let (_, log, said) = spoilt(|period, samples| {
        if (20_000..22_000).contains(&period) {
            samples.output = None;
        }
    });
    assert_eq!(said[21_999].source, Source::MotorOnly(Doubt::Silent));
    assert_eq!(said.last().map(|estimates| estimates.source), Some(Source::Both));
    GAP_COARSE.check(late_error(&log, &said));
}

#[test]
fn samples_that_make_no_sense_are_noticed_and_survived() {
    let (_, log, said) = spoilt(|period, samples| match period {
        20_000 => samples.torque = f64::NAN,
        20_500 => samples.motor.counts ^= 1 << 13,
        21_000 => samples.time = samples.time.wrapping_sub(50_000),
        21_500 => samples.torque = f64::INFINITY,
        _ => {}
    });
    assert!(said[20_000].notices.torque_unknown && !said[20_001].notices.torque_unknown);
    assert!(said[20_500].notices.motor_doubted && !said[20_502].notices.motor_doubted);
    assert!(said[21_000].notices.out_of_time && !said[21_010].notices.out_of_time);
    assert!(said[21_500].notices.torque_unknown);
    GAP_COARSE.check(late_error(&log, &said));
}

#[test]
fn a_motor_encoder_that_jumps_for_good_is_said_and_learnt_anew() {
    let (_, log, said) = spoilt(|period, samples| {
        if period >= 20_000 {
            samples.motor.counts = (samples.motor.counts + 4000) % (1 << 14);
        }
    });
    let jumped = said[20_000..20_010].iter().any(|estimates| estimates.notices.motor_jumped);
    assert!(jumped, "the jump is said");
    assert!(said.iter().all(|estimates| estimates.gap.value.is_finite()));
    let late = late_error(&log, &said);
    println!("after the jump: {late}");
}

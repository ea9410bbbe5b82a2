//! Late readings, by their own time stamps: no estimate diverges, unknown quantities are marked invalid, and a returning encoder is used
//! again.

use std::sync::LazyLock;

use host_tests::extent::cases;
use host_tests::tolerance::observer::GAP_WORST;
use model_core::observer::{OutputFault, Samples, Source};

use crate::experiment::{Encoders, Experiment};
use crate::motion::TestMotion;
use crate::recording::PeriodSample;
use crate::replay::samples;

/// Periods in which readings are late.
const LATE_PERIODS: core::ops::Range<usize> = 15_000..20_000;

/// Experiment and its recording.
type Recorded = (Experiment, Vec<PeriodSample>);

/// Experiment on a joint that swings against its inertia, and its recording.
fn swung(name: &str, amplitude: f64) -> Recorded {
    let mut experiment = Experiment::new(name, "inertia", Encoders::Preset, None, 31).lasting(3.0);
    experiment.setup.motion = TestMotion::Sine(amplitude, 1.0).motion(experiment.setup.seed);
    let log = experiment.record();
    (experiment, log)
}

/// Wide swing of a joint, recorded once for all tests.
fn to_and_fro(name: &str) -> &'static Recorded {
    static Q1: LazyLock<Recorded> = LazyLock::new(|| swung("q1", 0.5));
    static L1: LazyLock<Recorded> = LazyLock::new(|| swung("l1", 0.5));
    static D2: LazyLock<Recorded> = LazyLock::new(|| swung("d2", 0.5));
    static S1: LazyLock<Recorded> = LazyLock::new(|| swung("s1", 0.5));
    match name {
        "q1" => &Q1,
        "l1" => &L1,
        "d2" => &D2,
        "s1" => &S1,
        other => panic!("no swing of {other}"),
    }
}

/// Samples of `late` periods ago.
fn delayed_samples(experiment: &Experiment, log: &[PeriodSample], period: usize, late: usize) -> Samples<f32> {
    samples(&experiment.settings, &log[period - late], period - late)
}

/// Late output readings up to ten periods old still give the present gap.
#[test]
fn late_output_readings_locate_the_gap() {
    for &name in cases(&["q1", "l1", "d2"], 2) {
        let (experiment, log) = to_and_fro(name);
        let gap = 4.0 * experiment.setup.joint.sun_planet.half_backlash[0];
        for late in [2, 5, 10] {
            let published = experiment.published::<f32>(log, |period, samples| {
                if LATE_PERIODS.contains(&period) {
                    samples.output = delayed_samples(experiment, log, period, late).output;
                }
            });
            let of = |period: usize| (f64::from(published[period].gap.value) - log[period].gap).abs() / gap;
            let worst = LATE_PERIODS.map(of).fold(0.0, f64::max);
            println!("{name}, {late} periods late: {worst:.4} of the gap");
            GAP_WORST.check(worst);
            assert!(LATE_PERIODS.clone().all(|period| published[period].source == Source::Both), "{name}: excluded");
        }
    }
}

/// Output readings thirty periods old count as lost.
#[test]
fn old_output_readings_count_as_lost() {
    let (experiment, log) = to_and_fro("q1");
    let published = experiment.published::<f32>(log, |period, samples| {
        if LATE_PERIODS.contains(&period) {
            samples.output = delayed_samples(experiment, log, period, 30).output;
        }
    });
    assert_eq!(published[LATE_PERIODS.start + 150].source, Source::MotorOnly(OutputFault::Silent));
    assert_eq!(published[LATE_PERIODS.end - 1].source, Source::MotorOnly(OutputFault::Silent));
    assert_eq!(published.last().map(|estimates| estimates.source), Some(Source::Both), "it is readmitted");
}

/// Late motor readings keep the speed bounded and the gap invalid.
#[test]
fn late_motor_readings_are_invalid() {
    for &(name, late) in cases(&[("q1", 3), ("l1", 10), ("l1", 3), ("l1", 30), ("s1", 3)], 2) {
        let (experiment, log) = to_and_fro(name);
        let published = experiment.published::<f32>(log, |period, samples| {
            if LATE_PERIODS.contains(&period) {
                samples.motor = delayed_samples(experiment, log, period, late).motor;
            }
        });
        assert!(LATE_PERIODS.clone().all(|period| !published[period].gap.valid && !published[period].contact_valid));
        let fastest = LATE_PERIODS.map(|period| log[period].motor[1].abs()).fold(0.0, f64::max);
        let published_fastest =
            LATE_PERIODS.map(|period| f64::from(published[period].motor.speed).abs()).fold(0.0, f64::max);
        println!("{name}, {late} periods late: {published_fastest:.1} in place of {fastest:.1} rad/s");
        assert!(published_fastest < 2.0 * fastest, "{name}, {late} periods late: the motor runs away");
        let nothing = |mut periods: core::ops::Range<usize>| {
            periods.all(|period| matches!(published[period].source, Source::Nothing(_)))
        };
        assert!(
            nothing(LATE_PERIODS.start + 4..LATE_PERIODS.end + 31),
            "{name}, {late} periods late: the motor counts as read"
        );
        assert!(
            published.last().is_some_and(|estimates| !matches!(estimates.source, Source::Nothing(_))),
            "the motor is read again"
        );
    }
}

/// Lost motor readings cost little accuracy and validity.
#[test]
fn lost_motor_readings_cost_little() {
    for &name in cases(&["q1", "l1", "d2"], 2) {
        let (experiment, log) = to_and_fro(name);
        let gap = 4.0 * experiment.setup.joint.sun_planet.half_backlash[0];
        // Every ninth reading, and two in every seventy.
        let lost = |period: usize| LATE_PERIODS.contains(&period) && (period.is_multiple_of(9) || period % 70 < 2);
        let published = experiment.published::<f32>(log, |period, samples| {
            if lost(period) {
                let before = (0..period).rev().find(|before| !lost(*before)).unwrap_or(0);
                samples.motor = delayed_samples(experiment, log, period, period - before).motor;
            }
        });
        let of = |period: usize| (f64::from(published[period].gap.value) - log[period].gap).abs() / gap;
        let worst = LATE_PERIODS.map(of).fold(0.0, f64::max);
        let valid_share =
            LATE_PERIODS.filter(|period| published[*period].gap.valid).count() as f64 / LATE_PERIODS.len() as f64;
        println!("{name}: {worst:.4} of the gap, valid in {valid_share:.3} of all periods");
        GAP_WORST.check(worst);
        assert!(valid_share > 0.97, "{name}: not valid");
    }
}

/// A recovered output encoder is readmitted although the teeth are hardly loaded.
#[test]
fn recovered_output_is_readmitted_unloaded() {
    let (experiment, mut log) = swung("l1", 0.2);
    let counts = log[13_000].output_counts;
    log[13_000..20_000].iter_mut().for_each(|moment| moment.output_counts = counts);
    let published = experiment.published::<f32>(&log, |_, _| {});
    assert!(matches!(published[19_999].source, Source::MotorOnly(_)), "it is excluded");
    let back = published[20_000..].iter().position(|estimates| estimates.source == Source::Both);
    println!("readmitted after {back:?} periods");
    assert!(back.is_some_and(|periods| periods < 6_000), "it is readmitted");
}

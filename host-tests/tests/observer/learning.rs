//! Parameter estimation under difficulties: wearing teeth, forces within the torque bias, a transmission error larger than the gap. Errors
//! of ordinary joints are in `gap`.

use host_tests::extent::cases;
use host_tests::tolerance::observer::*;
use model_core::gears::Kinematics;
use model_core::observer::{MAPPED, Source};
use model_core::virtual_joint::fault::{Fault, FaultKind};
use reference::drive_train::Disturbance;
use scenario::file::HostOnlyFault;

use crate::experiment::{Encoders, Experiment};
use crate::motion::TestMotion;
use crate::presets::with_backlash;
use crate::replay::ObserverErrors;

/// The width of worn teeth is estimated anew, and the output encoder is kept.
#[test]
fn wear_is_learnt_and_encoder_kept() {
    for &(seed, worn) in cases(&[(31, 46e-6), (32, 60e-6), (33, 80e-6)], 1) {
        let mut experiment = Experiment::new("q1", "inertia", Encoders::Preset, Some(40e-6), seed).lasting(4.5);
        let kind = FaultKind::Other(HostOnlyFault::GrownBacklash(worn));
        experiment.setup.faults = vec![Fault { start: 2.0, end: f64::INFINITY, seed: (), kind }];
        let log = experiment.record();
        // Estimates are compared with the worn teeth.
        experiment.setup.joint = with_backlash(&experiment.setup.joint, worn);
        let mut kept = true;
        let figures = experiment
            .replay::<MAPPED>(&log, 3.0, |k, _, estimates| kept &= k < 10 || estimates.source == Source::Both);
        println!("{worn}: {figures:?}");
        GAP_COARSE.check(figures.gap);
        WIDTH.check(figures.width);
        assert!(kept, "wear is no failure of the encoder");
    }
}

/// Contacts of a few milliseconds on the opposite flank suffice for the width.
#[test]
fn brief_contact_reveals_the_width() {
    // At the start the teeth cross, rest on the opposite flank with a few newtons and return; the link reverses a second later.
    for &(half_backlash, seed) in cases(&[(56.744_186e-6, 657), (70e-6, 644), (63.33e-6, 646)], 1) {
        let experiment = Experiment::new("q1", "slow", Encoders::Preset, Some(half_backlash), seed).lasting(2.5);
        let figures = experiment.figures(&experiment.record(), 2.0);
        println!("{half_backlash}: {figures:?}");
        WIDTH_TIME.check(figures.width_after);
    }
}

/// Pushes from flank to flank suffice for the width although the link never rests there.
#[test]
fn bounces_reveal_the_width() {
    for (half_backlash, seed) in [(30e-6, 38), (40e-6, 37), (60e-6, 37)] {
        let mut experiment = Experiment::new("q1", "hold", Encoders::Preset, Some(half_backlash), seed).lasting(0.6);
        // Nothing brakes the link, so it bounces.
        experiment.setup.train.surroundings.load_friction.coulomb = 0.0;
        experiment.setup.train.surroundings.load_friction.viscous = 0.0;
        experiment.setup.train.surroundings.motor_friction.coulomb = 0.0;
        experiment.setup.train.surroundings.motor_friction.viscous = 0.0;
        experiment.setup.train.surroundings.cogging_torque = 0.0;
        let torque = 0.125 * experiment.setup.joint.rated_output_torque;
        experiment.setup.disturbances = vec![Disturbance::Pulse { start: 0.2, duration: 20e-3, torque }];
        let mut known = 0;
        let figures = experiment.replay::<MAPPED>(&experiment.record(), 0.5, |_, _, estimates| {
            known += usize::from(estimates.half_backlash.valid);
        });
        println!("{half_backlash}: {figures:?}, known for {known} periods");
        WIDTH_FROM_BOUNCES.check(figures.width.abs());
        assert!(known > 2000, "{half_backlash} was not learnt in passing");
    }
}

/// Errors of an experiment from a time on, with a torque bias of up to a tenth of the limit: three times this bias is more torque than the
/// motion needs.
fn errors_with_wide_bias(mut experiment: Experiment, from: f64) -> ObserverErrors {
    experiment.settings.torque_uncertainty = 0.1 * experiment.settings.torque_limit;
    experiment.figures(&experiment.record(), from)
}

/// Flanks are detected although no force exceeds the torque bias.
#[test]
fn flanks_are_detected_below_the_bias() {
    for (name, seed) in [("l1", 34), ("q1", 35)] {
        let experiment = Experiment::new(name, "inertia", Encoders::Preset, None, seed).lasting(4.0);
        let figures = errors_with_wide_bias(experiment, 2.5);
        println!("{name}: {figures:?}");
        GAP_COARSE.check(figures.gap);
        WIDTH.check(figures.width);
        assert!(figures.valid > 0.99, "{name}: the gap is not valid");
    }
}

/// Travel of the link gives the width of a joint with hardly any load.
#[test]
fn link_travel_reveals_the_width() {
    // The force that holds the teeth on their flanks is far below the torque bias, and the transmission error of S1 exceeds the distance
    // from the middle of the gap to a flank.
    let light = [("l1", 60e-6, 0.4, 40), ("s1", 20e-6, 0.7, 43), ("l1", 40e-6, 0.7, 42), ("s1", 20e-6, 0.7, 44)];
    for &(name, half_backlash, frequency, seed) in cases(&light, 2) {
        let mut experiment = Experiment::new(name, "inertia", Encoders::Preset, Some(half_backlash), seed).lasting(5.0);
        experiment.setup.motion = TestMotion::Sine(0.5, frequency).motion(experiment.setup.seed);
        let figures = errors_with_wide_bias(experiment, 3.5);
        println!("{name} {half_backlash} {seed}: {figures:?}");
        WIDTH.check(figures.width);
        assert!(figures.valid > 0.99, "{name}: the gap is not valid");
    }
}

/// Contact is not valid where the transmission error exceeds the gap.
#[test]
fn hidden_gap_has_no_valid_contact() {
    let experiment = Experiment::new("s1", "gravity", Encoders::Preset, None, 36).lasting(4.0);
    for (k, estimates) in experiment.published::<f64>(&experiment.record(), |_, _| {}).iter().enumerate() {
        assert!(k < 20_000 || !estimates.contact_valid, "contact at {k} would be over before anyone could act on it");
    }
}

/// Cogging is estimated while the link turns slowly, and left alone otherwise.
#[test]
fn cogging_is_learnt_in_slow_motion() {
    for &(name, amplitude, periods, seed) in
        cases(&[("q1", 0.03, 60, 72), ("q1", 0.02, 84, 71), ("q1", 0.0, 84, 73)], 1)
    {
        let mut experiment = Experiment::new(name, "slow", Encoders::Preset, Some(40e-6), seed).lasting(5.0);
        let around = &mut experiment.setup.train.surroundings;
        (around.cogging_torque, around.cogging_periods_per_turn) = (amplitude, periods);
        experiment.settings.cogging_periods = periods;
        let log = experiment.record();
        let [sine, cosine] = experiment.published::<f32>(&log, |_, _| {}).last().expect("it lasts").cogging;
        let at_link = |motor: f64| motor * experiment.setup.joint.geometry.ratio_by_teeth();
        let astray = f64::from(sine - at_link(amplitude) as f32).hypot(cosine.into());
        println!("{name}: cogging of {amplitude} N m is taken for {sine} and {cosine} at the link");
        COGGING.check(astray / at_link(0.02));
    }
    for &motion in cases(&["inertia", "hold"], 1) {
        let experiment = Experiment::new("q1", motion, Encoders::Preset, Some(40e-6), 74).lasting(4.0);
        let published = experiment.published::<f32>(&experiment.record(), |_, _| {});
        let [sine, cosine] = published.last().expect("it lasts").cogging.map(f64::from);
        println!("{motion}: {sine} and {cosine}");
        let amplitude = 0.02 * experiment.setup.joint.geometry.ratio_by_teeth();
        assert!((sine - amplitude).hypot(cosine) < 1.1 * amplitude, "{motion}: worse than nothing");
    }
}

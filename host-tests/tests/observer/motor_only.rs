//! Observer without an output encoder: its variance is consistent, and estimates without information are invalid.

use host_tests::tolerance::observer::MOTOR_ONLY_NEES;
use model_core::observer::{MAPPED, OutputFault, Source};

use crate::experiment::{Encoders, Experiment};

/// Experiment without an output encoder, with the width given to 2 %.
fn experiment(motion: &str, seed: u64) -> Experiment {
    let mut experiment = Experiment::new("q1", motion, Encoders::Preset, Some(40e-6), seed).lasting(4.0);
    experiment.nominal = experiment.setup.joint.clone();
    experiment.settings.output_encoder = None;
    experiment.settings.backlash_uncertainty = 0.02;
    experiment.settings.compliance_uncertainty = 0.05;
    experiment
}

/// The variance is consistent, and long separations make the gap invalid.
#[test]
fn variance_is_consistent() {
    for (motion, seed) in [("inertia", 31), ("gravity", 32)] {
        let experiment = experiment(motion, seed);
        let log = experiment.record();
        let (mut open_for, mut refused, mut long) = (0, 0, 0);
        let figures = experiment.replay::<MAPPED>(&log, 1.0, |_, moment, estimates| {
            assert_eq!(estimates.source, Source::MotorOnly(OutputFault::Absent));
            assert!(estimates.half_backlash.variance > 1e-14, "the width never counts as known for sure");
            open_for = if moment.sun_force == 0.0 { open_for + 1 } else { 0 };
            if open_for > 300 {
                long += 1;
                refused += usize::from(!estimates.gap.valid);
            }
        });
        println!("{motion}: {figures:?}; {refused} of {long} refused");
        MOTOR_ONLY_NEES.check(figures.nees);
        assert!(figures.valid > 0.2, "it says something");
        assert!(refused as f64 >= 0.95 * f64::from(long), "after 30 ms in the gap nothing is known");
    }
}

/// Without knowledge of the width, no gap is published as valid.
#[test]
fn unknown_width_stays_invalid() {
    let mut experiment = experiment("inertia", 33);
    experiment.settings.backlash_uncertainty = 0.5;
    experiment.replay::<MAPPED>(&experiment.record(), 1.0, |_, _, estimates| {
        assert!(!estimates.gap.valid && !estimates.half_backlash.valid);
    });
}

//! What is learnt where learning is hard: teeth that wear, forces that do not stand out of what bias can be, teeth whose
//! transmission error is larger than their gap. Figures of ordinary joints are in `gap`.

use host_tests::tolerance::observer::*;
use model_core::realtime::observer::{MAPPED, Observer, Source};

use crate::presets::with_backlash;
use crate::replay::{replay, samples};
use crate::trial::{Encoders, Trial};

#[test]
fn teeth_that_wear_are_learnt_anew_and_the_encoder_is_kept() {
    for (seed, worn) in [(31, 46e-6), (32, 60e-6), (33, 80e-6)] {
        let mut trial = Trial::new("q1", "inertia", Encoders::Preset, Some(40e-6), seed).lasting(4.5);
        trial.run.worn = Some((2.0, worn));
        let mut kept = true;
        let joint = with_backlash(&trial.run.joint, worn);
        let figures = replay::<f64, MAPPED>(
            &joint,
            &trial.tables(),
            &trial.settings,
            &trial.run.record(),
            3.0,
            |k, _, estimates| kept &= k < 10 || estimates.source == Source::Both,
        );
        println!("{worn}: {figures:?}");
        GAP_COARSE.check(figures.gap);
        WIDTH.check(figures.width);
        assert!(kept, "wear is no failure of the encoder");
    }
}

#[test]
fn flanks_are_told_without_a_force_that_stands_out_of_bias() {
    for (name, seed) in [("l1", 34), ("q1", 35)] {
        let mut trial = Trial::new(name, "inertia", Encoders::Preset, None, seed).lasting(4.0);
        // A tenth of the largest torque: three of that are more than the motion takes.
        trial.settings.torque_uncertainty = 0.1 * trial.settings.torque_limit;
        let log = trial.record();
        let figures =
            replay::<f64, MAPPED>(&trial.run.joint, &trial.tables(), &trial.settings, &log, 2.5, |_, _, _| {});
        println!("{name}: {figures:?}");
        GAP_COARSE.check(figures.gap);
        WIDTH.check(figures.width);
        assert!(figures.valid > 0.99, "{name} is not vouched for");
    }
}

#[test]
fn teeth_whose_error_is_larger_than_their_gap_are_not_vouched_for() {
    let trial = Trial::new("s1", "gravity", Encoders::Preset, None, 36).lasting(4.0);
    let tables = trial.tables();
    let mut observer = Observer::<f64, MAPPED>::new(&tables);
    for (k, moment) in trial.record().iter().enumerate() {
        let estimates = observer.step(&samples(&trial.settings, moment, k));
        assert!(k < 20_000 || !estimates.contact_valid, "contact at {k} would be over before anyone could act on it");
    }
}

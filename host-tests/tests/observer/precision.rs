//! Single against double precision, near the start and many turns away: counts are integers, so turns cost no precision.

use std::f64::consts::TAU;

use host_tests::tolerance::observer::SINGLE_PRECISION;
use model_core::observer::{MAPPED, Observer, Shaft};

use crate::experiment::{Encoders, Experiment};
use crate::replay::samples;

/// The gap in f32 agrees with f64 at the start and after 300 turns.
#[test]
fn single_precision_is_enough() {
    let experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), 41).lasting(3.0);
    let log = experiment.record();
    for turns in [0, 300] {
        let (single, double) = (experiment.tables::<f32>(), experiment.tables::<f64>());
        let mut single = Observer::<f32, MAPPED>::new(&single);
        let mut double = Observer::<f64, MAPPED>::new(&double);
        // Before the recording the joint moves there smoothly, at about four output turns a second.
        let mut period = 0;
        let train = &experiment.setup.train;
        let (motor_turn, output_turn) = (
            train.surroundings.motor_encoder.counts_per_turn as i64,
            train.surroundings.output_encoder.counts_per_turn as i64,
        );
        let steps = turns * 10_000 / 4;
        for step in 0..steps {
            let part = step as f64 / steps as f64;
            let way = turns as f64 * part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
            let mut moment = log[0];
            moment.command = 0.0;
            moment.motor_counts += (way * 6.0 * motor_turn as f64).floor() as i64;
            moment.output_counts += (way * output_turn as f64).floor() as i64;
            single.step(&samples(&experiment.settings, &moment, period));
            double.step(&samples(&experiment.settings, &moment, period));
            period += 1;
        }
        let (mut sum, mut began) = (0.0, None);
        for moment in &log {
            let mut moment = *moment;
            moment.motor_counts += motor_turn * 6 * turns;
            moment.output_counts += output_turn * turns;
            let single = *single.step(&samples(&experiment.settings, &moment, period));
            let double = *double.step(&samples(&experiment.settings, &moment, period));
            period += 1;
            sum += (f64::from(single.gap.value) - double.gap.value).powi(2);
            let turned = |shaft: &Shaft<f64>| f64::from(shaft.turns) + shaft.fraction;
            let began = *began.get_or_insert(turned(&double.link) - moment.link[0] / TAU);
            assert!((turned(&double.link) - began - moment.link[0] / TAU).abs() < 1e-3);
            assert!((began - turns as f64).abs() < 1.01, "{began} turns instead of {turns}");
        }
        SINGLE_PRECISION.check((sum / log.len() as f64).sqrt() / 160e-6);
    }
}

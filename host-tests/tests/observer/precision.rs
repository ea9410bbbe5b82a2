//! Single precision against double, near the start and far from it: counts are whole numbers, so turns cost nothing.

use host_tests::tolerance::observer::SINGLE_PRECISION;
use model_core::realtime::observer::{MAPPED, Observer};

use crate::replay::samples;
use crate::trial::{Encoders, Trial};

#[test]
fn single_precision_is_enough_at_the_start_and_after_300_turns() {
    let trial = Trial::new("q1", "gravity", Encoders::Preset, Some(40e-6), 41).lasting(3.0);
    let log = trial.record();
    for turns in [0, 300] {
        let (single, double) = (trial.tables::<f32>(), trial.tables::<f64>());
        let mut single = Observer::<f32, MAPPED>::new(&single);
        let mut double = Observer::<f64, MAPPED>::new(&double);
        // 300 output turns are 1800 motor turns; the joint goes there at 40 turns a second before the recording begins.
        let mut period = 0;
        let bits = (trial.run.train.motor_encoder.bits, trial.run.train.output_encoder.bits);
        let (motor_turn, output_turn) = (1_i64 << bits.0, 1_i64 << bits.1);
        let steps = turns * 10_000 / 40;
        for step in 0..steps {
            let mut moment = log[0];
            moment.command = 0.0;
            moment.motor_counts += motor_turn * 6 * step * 40 / 10_000;
            moment.output_counts += output_turn * step * 40 / 10_000;
            single.step(&samples(&trial.settings, &moment, period));
            double.step(&samples(&trial.settings, &moment, period));
            period += 1;
        }
        let mut sum = 0.0;
        for moment in &log {
            let mut moment = *moment;
            moment.motor_counts += motor_turn * 6 * turns;
            moment.output_counts += output_turn * turns;
            let single = *single.step(&samples(&trial.settings, &moment, period));
            let double = *double.step(&samples(&trial.settings, &moment, period));
            period += 1;
            sum += (f64::from(single.gap.value) - double.gap.value).powi(2);
            assert_eq!(single.link.turns, double.link.turns);
        }
        SINGLE_PRECISION.check((sum / log.len() as f64).sqrt() / 160e-6);
    }
}

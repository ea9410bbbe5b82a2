//! Long run over many seeds, half-backlashes, motions and encoders, which prints the largest value of each error.
//! Ignored by default because it takes minutes.

use model_core::observer::{MAPPED, Source};

use crate::experiment::{Encoders, Experiment, MOTIONS};
use crate::replay::{ObserverErrors, with_encoders};

/// First seed of the long run; nothing was tuned on these seeds.
const FIRST_SEED: u64 = 300;

/// Number of seeds of the long run.
const SEEDS: u64 = 20;

/// Prints the worst errors over 20 seeds and checks that no encoder is excluded.
#[test]
#[ignore = "takes minutes: cargo test --release -p host-tests --test observer -- --ignored --nocapture"]
fn worst_of_many_seeds() {
    for (motion, _) in MOTIONS {
        let mut worst = [0; 3].map(|_| ObserverErrors::default());
        let mut alarms = 0;
        for seed in FIRST_SEED..FIRST_SEED + SEEDS {
            let half_backlash = Some(20e-6 + 60e-6 * ((seed * 7 % SEEDS) as f64 / (SEEDS - 1) as f64));
            let base = Experiment::new("q1", motion, Encoders::Preset, half_backlash, seed);
            let log = base.record();
            let kinds = [Encoders::Ideal, Encoders::Bits(16, 18), Encoders::Preset];
            for (encoders, worst) in kinds.into_iter().zip(&mut worst) {
                let experiment = Experiment::new("q1", motion, encoders, half_backlash, seed);
                let log = with_encoders(&log, &experiment.setup.train);
                let figures = experiment.replay::<MAPPED>(&log, 2.0, |_, _, estimates| {
                    alarms += usize::from(estimates.source != Source::Both);
                });
                *worst = worst.worse(&figures);
            }
        }
        for (name, worst) in ["18/18 ideal", "16/18", "14/17"].iter().zip(worst) {
            let [median, late] = [0.5, 0.95].map(|part| worst.delay(part));
            let worst = ObserverErrors { delays: Vec::new(), ..worst };
            println!("{motion}, {name}: worst of {SEEDS}: delays {median} s, {late} s; {worst:?}");
        }
        assert_eq!(alarms, 0, "a false alarm");
    }
}

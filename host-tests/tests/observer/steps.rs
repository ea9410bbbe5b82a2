//! The width in steps between two places, in the loop with the compensation, whose soft landings leave little to learn from.
//! Motions under a plain motor controller are in `gap`.

use host_tests::tolerance::observer::{WIDTH_AFTER, WIDTH_IN_STEPS, WIDTH_IN_STEPS_WORST};
use model_core::compensation::design::design_compensation;
use model_core::observer::design::design_observer;
use reference::closed_loop::Bench;
use scenario::compensated::{Compensated, compensation_settings, observer_settings};
use scenario::trial::Trial;

use crate::presets::{preset, with_backlash};

const CASES: [(f64, f64, u64); 7] = [
    (20e-6, 1.5, 1),
    (20e-6, 0.5, 2),
    (20e-6, 1.5, 3),
    (20e-6, 1.5, 4),
    (20e-6, 0.5, 6),
    (30e-6, 0.5, 3),
    (40e-6, 0.5, 1),
];

#[test]
fn steps_between_two_places_show_the_width() {
    let mut squares = 0.0;
    for (half_backlash, guess, seed) in CASES {
        let (joint, train) = preset("q1", seed);
        let trial = Trial::steps(&with_backlash(&joint, half_backlash), &train, seed);
        let train = &trial.bench.train;
        let told = with_backlash(&joint, guess * half_backlash);
        let tables = design_compensation::<f32>(&told, &compensation_settings(train, trial.bandwidth)).expect("tables");
        let observer = design_observer::<f32>(&told, &observer_settings(train)).expect("tables");
        let mut controller = Compensated::observed(&tables, &observer, train);
        controller.trace = Some(Vec::new());
        let run = Bench { preview: None, ..trial.bench.clone() }.run(&mut controller, &trial.motion).expect("it runs");
        let (mut moving, mut right_after, mut width) = (0.0, 0.0, 0.0);
        let trace = controller.trace.expect("it was kept");
        for (sample, (_, estimates)) in run.samples.iter().zip(trace.iter().skip(1)) {
            moving += if sample.gap.abs() > 0.95 && sample.link_speed.abs() > 1e-3 { run.period } else { 0.0 };
            width = f64::from(estimates.half_backlash.value) / half_backlash - 1.0;
            right_after = if width.abs() > 0.05 { moving } else { right_after };
        }
        println!(
            "{half_backlash}, guess {guess}, seed {seed}: {width:+.4}, right after {right_after} s of motion in contact"
        );
        WIDTH_IN_STEPS_WORST.check(width);
        WIDTH_AFTER.check(right_after);
        squares += width * width;
    }
    WIDTH_IN_STEPS.check((squares / CASES.len() as f64).sqrt());
}

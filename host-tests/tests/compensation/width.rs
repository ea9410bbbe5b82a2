//! Estimated width in steps between two places under the compensation, whose soft landings carry little information. Motions under a plain
//! motor controller are in the observer's tests.

use host_tests::extent::cases;
use host_tests::tolerance::observer::{WIDTH_FROM_STEPS, WIDTH_FROM_STEPS_WORST, WIDTH_TIME_IN_STEPS};
use scenario::controller::ControllerName::NoPreview;
use scenario::random::NumberOrRange;

use super::{changed, run};

/// Half-backlash [um], guess over it, seed.
const CASES: [(f64, f64, u64); 7] =
    [(20.0, 1.5, 1), (20.0, 0.5, 2), (20.0, 1.5, 3), (20.0, 1.5, 4), (20.0, 0.5, 6), (30.0, 0.5, 3), (40.0, 0.5, 1)];

/// Steps between two places suffice to estimate the half-backlash to 5 %.
#[test]
fn steps_reveal_the_width() {
    let mut squares = 0.0;
    let cases = cases(&CASES, 2);
    for &(half_backlash, guess, seed) in cases {
        let mut test = changed("steps-no-preview", "", &format!("[known]\nmesh.half_backlash_um = {half_backlash}"));
        test.file.width_guess = Some(NumberOrRange::Exactly(guess));
        let history = run(&test, seed, NoPreview);
        let (mut moving, mut right_after, mut width) = (0.0, 0.0, 0.0);
        // A sample is taken at the end of its period, where the estimates of the next period are made.
        for ((sample, truth), observed) in
            history.run.samples.iter().zip(&history.truths).zip(history.observer_outputs.iter().skip(1))
        {
            moving += if sample.gap.abs() > 0.95 && sample.link_speed.abs() > 1e-3 { history.run.period } else { 0.0 };
            width = f64::from(observed.half_backlash) / truth.half_backlash - 1.0;
            right_after = if width.abs() > 0.05 { moving } else { right_after };
        }
        println!(
            "{half_backlash} um, guess {guess}, seed {seed}: {width:+.4}, right after {right_after} s of motion in contact"
        );
        WIDTH_FROM_STEPS_WORST.check(width);
        WIDTH_TIME_IN_STEPS.check(right_after);
        squares += width * width;
    }
    WIDTH_FROM_STEPS.check((squares / cases.len() as f64).sqrt());
}

//! The long form: fifty random plants, half on steps without preview and half on random motions. It prints each figure; run it with `cargo
//! test --release -p host-tests --test compensation -- --ignored --nocapture`. `cargo joint hil --full` runs every test of `hil/` on twenty
//! seeds.

use host_tests::tolerance::compensation::{PLANTS_MEDIAN, PLANTS_WORST};
use scenario::controller::ControllerName::{MotorPid, NoPreview};

use super::{figures, shipped};

/// Median and worst RMS error over fifty random plants.
#[test]
#[ignore = "minutes of computing"]
fn fifty_random_plants() {
    let mut ratios = Vec::new();
    for name in ["random-plants", "random-plants-random-motion"] {
        let test = shipped(name);
        for seed in 1..=25 {
            let (pid, ours) = (figures(&test, seed, MotorPid), figures(&test, seed, NoPreview));
            println!("{name}, seed {seed}: rms {:.3} peak {:.3} of PID's", ours.rms / pid.rms, ours.peak / pid.peak);
            ratios.push(ours.rms / pid.rms);
        }
    }
    ratios.sort_by(f64::total_cmp);
    PLANTS_MEDIAN.check(ratios[ratios.len() / 2]);
    PLANTS_WORST.check(ratios[ratios.len() - 1]);
}

//! Errors that `joint check` and `joint budget` state for a joint, against the errors that `joint sim` measures on the same motion with the
//! independent reference: random joints, boards and rates by seed.
//!
//! The long form, 50 joints on whole motions: `cargo test --release -p host-tests --test design -- --ignored --nocapture`;
//! `CERTIFICATE_JOINTS` and `CERTIFICATE_SEED` choose others, `CERTIFICATE_MS` cuts the motions off.

use board::device::board::Board;
use board::device::tick_time::RateCheck;
use host_tests::extent::cases;
use host_tests::tolerance::certificate::{OTHER_ABOVE_BOUND, STANDARD_ABOVE_BOUND, TYPICAL, TYPICAL_MEDIAN};
use parameters::JointParameters;
use rayon::prelude::*;
use reference::scenarios::random_joint;
use simulation::accuracy::{Kind, Motion, MotionErrors, measure_up_to};
use simulation::sim::comparison::errors_against_reference;
use simulation::sim::errors::Errors;
use simulation::sim::scheme::SchemeName;

const RATES: [u32; 3] = [10_000, 20_000, 40_000];
const BOARDS: [&str; 3] = ["olimex-h405", "nucleo-g474re", "nucleo-h743zi"];
/// Motion outside the certificate: shift of the mesh phases [periods], torques over the standard ones; longest duration [s].
const OTHER_MOTION: (f64, f64) = (0.17, 0.9);
const OTHER_DURATION: f64 = 1.5;

/// Certificate of a joint compared with measurements.
struct Comparison {
    /// Typical error over the measured one, of deflections, gap and link, for each motion.
    ratios: Vec<f64>,
    standard_above: bool,
    other_above: bool,
}

/// Errors of the board's step on a motion, as `joint sim --scheme all` measures them.
fn measured_by_sim(motion: &Motion, board: &Board) -> Option<Errors> {
    errors_against_reference(&motion.simulation_spec(board.processor()), SchemeName::Realtime)
        .expect("a motion that the reference can follow")
}

fn compare(seed: u64, longest: f64) -> Comparison {
    let draw = |of: &[&'static str]| of[(seed / 3) as usize % of.len()];
    let (joint, board) = (random_joint(seed), Board::load(draw(&BOARDS)).expect("a preset"));
    let lowest = RateCheck::plant(&joint, &board).lowest_rate();
    let rate = RATES[seed as usize % RATES.len()].max(lowest.next_multiple_of(5000));
    let stated = measure_up_to(&joint, &board.processor(), rate, longest).expect("a joint that can be stepped");
    let mut all = Comparison { ratios: Vec::new(), standard_above: false, other_above: false };
    for (kind, stated) in [(Kind::Reversals, stated.reversals), (Kind::Steady, stated.steady)] {
        let motion = |other, longest| Motion::new(kind, &joint, rate, other, longest).expect("a motion");
        let found = measured_by_sim(&motion((0.0, 1.0), longest), &board);
        let other = measured_by_sim(&motion(OTHER_MOTION, longest.min(OTHER_DURATION)), &board);
        println!("{}", table_row(seed, &joint, &board, rate, kind, &stated, found, other));
        let (Some(found), Some(typical), Some(bound)) = (found, stated.typical, stated.bound) else {
            assert!(found.is_none() && stated.typical.is_none(), "seed {seed}: one can be told, the other not");
            continue;
        };
        let three = |errors: Errors| [errors.deflections, errors.gap, errors.link];
        let above = |errors: Errors| three(errors).iter().zip(three(bound)).any(|(error, bound)| *error > bound);
        all.ratios.extend(three(typical).iter().zip(three(found)).map(|(typical, found)| typical / found));
        all.standard_above |= above(found);
        all.other_above |= other.is_some_and(above);
    }
    all
}

#[expect(clippy::too_many_arguments, reason = "one line of a table")]
fn table_row(
    seed: u64,
    joint: &JointParameters,
    board: &Board,
    rate: u32,
    kind: Kind,
    stated: &MotionErrors,
    found: Option<Errors>,
    other: Option<Errors>,
) -> String {
    let three = |errors: Option<Errors>| {
        errors.map_or("none".to_owned(), |errors| {
            format!("{:.1e} {:.1e} {:.1e}", errors.deflections, errors.gap, errors.link)
        })
    };
    let substeps = RateCheck::plant(joint, board).substeps(rate).map_or(String::new(), |substeps| substeps.to_string());
    format!(
        "{seed}: {} planets, {} at {rate} Hz, {substeps}, {kind:?}: typical {}, sim {}; bound {}, another motion {}",
        joint.geometry.planets,
        board.name(),
        three(stated.typical),
        three(found),
        three(stated.bound),
        three(other)
    )
}

fn check(seeds: &[u64], longest: f64) {
    let all: Vec<Comparison> = seeds.par_iter().map(|seed| compare(*seed, longest)).collect();
    let mut factors: Vec<f64> =
        all.iter().flat_map(|one| &one.ratios).map(|ratio| ratio.max(1.0 / ratio) - 1.0).collect();
    factors.sort_by(f64::total_cmp);
    let share = |above: fn(&Comparison) -> bool| all.iter().filter(|one| above(one)).count() as f64 / all.len() as f64;
    TYPICAL_MEDIAN.check(factors[factors.len() / 2]);
    TYPICAL.check(factors[factors.len() - 1]);
    STANDARD_ABOVE_BOUND.check(share(|one| one.standard_above));
    OTHER_ABOVE_BOUND.check(share(|one| one.other_above));
}

fn from_environment(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |typed| typed.parse().expect("a whole number"))
}

/// Stated errors match measured errors on random joints, two in the short form, on shortened motions.
#[test]
fn certificate_matches_sim() {
    // Cut off a tenth of a second after the first crossing of the gap.
    check(cases(&[103, 101, 100, 102, 104, 105], 2), 1.3);
}

/// Stated errors match measured errors on fifty random joints.
#[test]
#[ignore = "fifty joints on whole motions take minutes"]
fn certificate_matches_sim_on_fifty_joints() {
    let first = from_environment("CERTIFICATE_SEED", 1000);
    let longest = 1e-3 * from_environment("CERTIFICATE_MS", 60_000) as f64;
    let seeds: Vec<u64> = (first..first + from_environment("CERTIFICATE_JOINTS", 50)).collect();
    check(&seeds, longest);
}

//! What `joint check` and `joint budget` say of a joint's error, against what `joint sim` measures on the same motion with the
//! independent reference: random joints, boards and rates by seed.
//!
//! The long form, 50 joints on whole motions: `cargo test --release -p host-tests --test design -- --ignored --nocapture`;
//! `CERTIFICATE_JOINTS` and `CERTIFICATE_SEED` choose others, `CERTIFICATE_MS` cuts the motions off.

use board::device::board::Board;
use board::device::tick_time::OnBoard;
use host_tests::tolerance::certificate::{ABOVE_OTHER, ABOVE_STANDARD, TYPICAL, TYPICAL_USUAL};
use parameters::JointParameters;
use rayon::prelude::*;
use reference::scenarios::random_joint;
use simulation::accuracy::{Kind, Motion, MotionErrors, measure_up_to};
use simulation::sim::comparison::errors_against_reference;
use simulation::sim::errors::Errors;
use simulation::sim::scheme::SchemeName;

const RATES: [u32; 3] = [10_000, 20_000, 40_000];
const BOARDS: [&str; 3] = ["olimex-h405", "nucleo-g474re", "nucleo-h743zi"];
/// A motion that the certificate does not measure: mesh phases shifted by part of a period, torques over the standard ones; so long
/// at most [s].
const OTHER: (f64, f64) = (0.17, 0.9);
const OTHER_DURATION: f64 = 1.5;

/// A joint's certificate beside what was measured.
struct Compared {
    /// Typical error over the measured one, of deflections, gap and link; of each motion.
    ratios: Vec<f64>,
    standard_above: bool,
    other_above: bool,
}

/// What `joint sim --scheme all` says of the board's step on a motion.
fn in_sim(motion: &Motion, board: &Board) -> Option<Errors> {
    errors_against_reference(&motion.simulation_spec(board.processor()), SchemeName::Realtime)
        .expect("a motion that the reference can follow")
}

fn compared(seed: u64, longest: f64) -> Compared {
    let draw = |of: &[&'static str]| of[(seed / 3) as usize % of.len()];
    let (joint, board) = (random_joint(seed), Board::load(draw(&BOARDS)).expect("a preset"));
    let lowest = OnBoard::plant(&joint, &board).lowest_rate();
    let rate = RATES[seed as usize % RATES.len()].max(lowest.next_multiple_of(5000));
    let told = measure_up_to(&joint, &board.processor(), rate, longest).expect("a joint that can be stepped");
    let mut all = Compared { ratios: Vec::new(), standard_above: false, other_above: false };
    for (kind, told) in [(Kind::Reversals, told.reversals), (Kind::Steady, told.steady)] {
        let motion = |other, longest| Motion::new(kind, &joint, rate, other, longest).expect("a motion");
        let found = in_sim(&motion((0.0, 1.0), longest), &board);
        let other = in_sim(&motion(OTHER, longest.min(OTHER_DURATION)), &board);
        println!("{}", line(seed, &joint, &board, rate, kind, &told, found, other));
        let (Some(found), Some(typical), Some(bound)) = (found, told.typical, told.bound) else {
            assert!(found.is_none() && told.typical.is_none(), "seed {seed}: one can be told, the other not");
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
fn line(
    seed: u64,
    joint: &JointParameters,
    board: &Board,
    rate: u32,
    kind: Kind,
    told: &MotionErrors,
    found: Option<Errors>,
    other: Option<Errors>,
) -> String {
    let three = |errors: Option<Errors>| {
        errors.map_or("none".to_owned(), |errors| {
            format!("{:.1e} {:.1e} {:.1e}", errors.deflections, errors.gap, errors.link)
        })
    };
    let substeps = OnBoard::plant(joint, board).substeps(rate).map_or(String::new(), |substeps| substeps.to_string());
    format!(
        "{seed}: {} planets, {} at {rate} Hz, {substeps}, {kind:?}: typical {}, sim {}; bound {}, another motion {}",
        joint.geometry.planets,
        board.name(),
        three(told.typical),
        three(found),
        three(told.bound),
        three(other)
    )
}

fn check(seeds: impl IntoParallelIterator<Item = u64>, longest: f64) {
    let all: Vec<Compared> = seeds.into_par_iter().map(|seed| compared(seed, longest)).collect();
    let mut factors: Vec<f64> =
        all.iter().flat_map(|one| &one.ratios).map(|ratio| ratio.max(1.0 / ratio) - 1.0).collect();
    factors.sort_by(f64::total_cmp);
    let share = |above: fn(&Compared) -> bool| all.iter().filter(|one| above(one)).count() as f64 / all.len() as f64;
    TYPICAL_USUAL.check(factors[factors.len() / 2]);
    TYPICAL.check(factors[factors.len() - 1]);
    ABOVE_STANDARD.check(share(|one| one.standard_above));
    ABOVE_OTHER.check(share(|one| one.other_above));
}

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |typed| typed.parse().expect("a whole number"))
}

#[test]
fn the_certificate_says_what_sim_measures_on_random_joints() {
    // Cut off a tenth of a second behind the first crossing of the gap.
    check(100..106, 1.3);
}

#[test]
#[ignore = "fifty joints on whole motions take minutes"]
fn the_certificate_says_what_sim_measures_on_fifty_random_joints() {
    let first = number("CERTIFICATE_SEED", 1000);
    let longest = 1e-3 * number("CERTIFICATE_MS", 60_000) as f64;
    check(first..first + number("CERTIFICATE_JOINTS", 50), longest);
}

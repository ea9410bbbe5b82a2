//! Logs from which nothing can be identified, each with the reason and the help. A reason that concerns one parameter
//! only is given with that parameter.

use super::log::Log;
use super::prior::PriorModel;
use super::rows::Rows;
use report::failure::{Failure, Outcome};

/// Changes of flank that are needed: from fewer the gap is a guess.
const LEAST_CROSSINGS: usize = 4;
/// Moments near lost samples are left out; more than so many of them, and the rest is no test.
const MOST_LEFT_OUT: f64 = 0.7;
/// Time that each flank must carry in all [s].
const LEAST_CARRIED: f64 = 0.1;

/// Refuses a log without a usable reversal test in it.
pub fn check(log: &Log, rows: &Rows, prior: &PriorModel) -> Outcome<()> {
    if rows.left_out > MOST_LEFT_OUT {
        return Err(Failure::new(format!(
            "samples are lost so often that {:.0} % of this log's moments have one near them",
            100.0 * rows.left_out
        ))
        .with_help("record so that samples arrive, or log every second one of them"));
    }
    let (least, most) =
        log.torque.iter().fold((f64::MAX, f64::MIN), |(least, most), &torque| (least.min(torque), most.max(torque)));
    let friction = prior.surroundings.motor_friction.coulomb;
    if least >= 0.0 || most <= 0.0 {
        return Err(Failure::new(format!(
            "there is no reversal in this log: the motor torque stays between {least:.4} and {most:.4} N m"
        ))
        .with_help("let the torque change its sign several times, so that both flanks of the teeth carry"));
    }
    if most.min(-least) <= 2.0 * friction {
        return Err(Failure::new(format!(
            "the torque is too small to close both flanks: {:.4} N m to one side, against {friction:.4} N m of dry friction",
            most.min(-least)
        ))
        .with_help("let the torque reach several times the motor's friction to both sides"));
    }
    if rows.crossings < LEAST_CROSSINGS {
        return Err(Failure::new(format!(
            "too few crossings: the carrying flank changes {} times in this log, {LEAST_CROSSINGS} are needed",
            rows.crossings
        ))
        .with_help("reverse the torque more often, and hold it for some hundredths of a second each time"));
    }
    for (side, name) in [(1.0, "drive"), (-1.0, "back")] {
        let carried = rows.carrying().filter(|row| row.side == side).count() as f64 * rows.step;
        if carried < LEAST_CARRIED {
            return Err(Failure::new(format!(
                "the {name} flank carries for {:.0} ms only, {:.0} ms are needed",
                1e3 * carried,
                1e3 * LEAST_CARRIED
            ))
            .with_help("hold the torque longer after each reversal, to both sides"));
        }
    }
    Ok(())
}

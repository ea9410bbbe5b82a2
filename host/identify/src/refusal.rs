//! Rejection of logs without a usable reversal test, with reason and remedy. A reason for one parameter only is part of
//! that parameter's finding.

use super::log::Log;
use super::prior::PriorModel;
use super::rows::Rows;
use report::failure::{Failure, Outcome};

/// Least changes of flank for an estimate of the gap.
const CROSSINGS_MIN: usize = 4;
/// Largest share of moments that may be excluded near lost samples.
const EXCLUDED_SHARE_MAX: f64 = 0.7;
/// Least time that each flank carries [s].
const CARRYING_TIME_MIN: f64 = 0.1;

/// Rejects a log without a usable reversal test.
pub fn check(log: &Log, rows: &Rows, prior: &PriorModel) -> Outcome<()> {
    if rows.excluded_share > EXCLUDED_SHARE_MAX {
        return Err(Failure::new(format!(
            "too many samples are lost: {:.0} % of this log's moments are near a lost sample",
            100.0 * rows.excluded_share
        ))
        .with_help("record without losses, or log every second sample"));
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
    if rows.crossings < CROSSINGS_MIN {
        return Err(Failure::new(format!(
            "too few crossings: the carrying flank changes {} times in this log, {CROSSINGS_MIN} are needed",
            rows.crossings
        ))
        .with_help("reverse the torque more often, and hold it for some hundredths of a second each time"));
    }
    for (side, name) in [(1.0, "drive"), (-1.0, "back")] {
        let carried = rows.carrying().filter(|row| row.flank == side).count() as f64 * rows.step;
        if carried < CARRYING_TIME_MIN {
            return Err(Failure::new(format!(
                "the {name} flank carries for {:.0} ms only, {:.0} ms are needed",
                1e3 * carried,
                1e3 * CARRYING_TIME_MIN
            ))
            .with_help("hold the torque longer after each reversal, in both directions"));
        }
    }
    Ok(())
}

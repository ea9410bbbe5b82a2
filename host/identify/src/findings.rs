//! What was found, each with its 95 % interval in the joint file's unit and the key that it belongs to, or the reason why
//! the log does not show it: `gap`, `brakes` and `angles`. Fitting is left to `twist` and `friction`, showing to `page`.

mod angles;
mod brakes;
mod finding;
mod gap;

pub use finding::Finding;

use super::log::Log;
use super::plan::Plan;
use super::rows::Rows;
use super::twist::Twist;

/// Everything that a log shows of a joint.
pub fn gather(log: &Log, quick: &Rows, slow: &Rows, twist: &Twist, plan: &Plan) -> Vec<Finding> {
    let mut findings = gap::gap_and_compliance(log, twist, plan);
    findings.extend(brakes::frictions(quick, slow, twist, plan));
    findings.extend(angles::maps(twist, plan));
    findings.push(angles::skew(log, twist, plan));
    findings
}

//! What was found, each with its 95 % interval in the joint file's unit and the key that it belongs to, or the reason
//! why the log does not show it: `gap`, `brakes` and `angles`.

pub(crate) mod angles;
mod brakes;
mod finding;
mod gap;

pub use finding::Finding;

use serde::Serialize;

use super::log::Log;
use super::plan::Plan;
use super::rows::Rows;
use super::twist::Twist;

/// What identification leaves behind as JSON, and on its page.
#[derive(Debug, Serialize)]
pub struct Record<'a> {
    /// Name and version of this form.
    pub schema: &'static str,
    /// Name of the joint.
    pub joint: &'a str,
    /// Name of the log.
    pub log: &'a str,
    /// How long it is [s].
    pub duration_s: f64,
    /// Changes of the carrying flank in it.
    pub crossings: usize,
    /// What the numbers rest on.
    pub assumptions: &'a [String],
    /// What was found.
    pub findings: &'a [Finding],
}

/// Everything that a log shows of a joint.
pub fn gather(log: &Log, quick: &Rows, slow: &Rows, twist: &Twist, plan: &Plan) -> Vec<Finding> {
    let mut findings = gap::gap_and_compliance(log, twist, plan);
    findings.extend(brakes::frictions(quick, slow, twist, plan));
    findings.extend(angles::maps(twist, plan));
    findings.push(angles::skew(log, twist, plan));
    findings
}

//! Identified parameters, each with its 95 % interval in the joint file's unit and its key, or the reason why the log
//! does not determine it: `gap`, `brakes`, `inertias` and `angles`.

pub(crate) mod angles;
mod brakes;
mod feigned;
mod finding;
pub(crate) mod gap;
mod inertias;

pub use finding::Finding;
pub(crate) use finding::{SHARE, finding};

use serde::Serialize;

use super::log::Log;
use super::prior::PriorModel;
use super::rows::Rows;
use super::scales::Doubt;
use super::twist::Twist;

/// Record of an identification, for JSON and the report.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Record<'a> {
    /// Name and version of the format.
    pub schema: &'static str,
    /// Name of the joint.
    pub joint: &'a str,
    /// Name of the log.
    pub log: &'a str,
    /// Length of the log [s].
    pub duration_s: f64,
    /// Changes of the carrying flank.
    pub crossings: usize,
    /// Assumptions behind the numbers.
    pub assumptions: &'a [String],
    /// Identified parameters.
    pub findings: &'a [Finding],
}

/// All findings of a log; `doubt` is the uncertainty of a torque and inertias that scale each other.
pub fn gather(
    log: &Log,
    [quick, slow]: [&Rows; 2],
    twist: &Twist,
    prior: &PriorModel,
    doubt: Option<&Doubt>,
) -> Vec<Finding> {
    let mut findings = gap::gap_and_compliance(log, quick, twist, prior, doubt);
    findings.extend(brakes::frictions([quick, slow], twist, prior, doubt));
    findings.extend(doubt.iter().flat_map(|doubt| inertias::inertias(&doubt.scales, prior)));
    findings.extend(angles::maps(twist, prior));
    findings.push(angles::skew(log, twist, prior, doubt.map_or(0.0, |doubt| doubt.scales.rates)));
    findings
}

//! Identified parameters, each with its 95 % interval in the joint file's unit and its key, or the reason why the log
//! does not determine it: `gap`, `friction`, `inertias` and `angles`.

pub(crate) mod angles;
mod finding;
mod friction;
pub(crate) mod gap;
mod inertias;
mod quantisation;

pub use finding::Finding;
pub(crate) use finding::{FOUND_INTERVAL_SHARE, finding};

use serde::Serialize;

use super::log::Log;
use super::prior::PriorModel;
use super::rows::Rows;
use super::scales::ScaleUncertainty;
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
    uncertainty: Option<&ScaleUncertainty>,
) -> Vec<Finding> {
    let mut findings = gap::gap_and_compliance(log, quick, twist, prior, uncertainty);
    findings.extend(friction::frictions([quick, slow], twist, prior, uncertainty));
    findings.extend(uncertainty.iter().flat_map(|uncertainty| inertias::inertias(&uncertainty.scales, prior)));
    findings.extend(angles::encoder_errors(twist, prior));
    findings.push(angles::skew(
        log,
        twist,
        prior,
        uncertainty.map_or(0.0, |uncertainty| uncertainty.scales.rate_error),
    ));
    findings
}

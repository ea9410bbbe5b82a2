//! Results of a log of any kind: the source of report, joint file and JSON.

use super::findings::Finding;
use report::plot::Figure;

/// Results of a log.
pub struct Results {
    /// Length of the log [s].
    pub duration: f64,
    /// Crossings of the gap.
    pub crossings: usize,
    /// Assumptions behind the numbers.
    pub assumptions: Vec<String>,
    /// Parameters, each with its interval or the reason for a missing one.
    pub findings: Vec<Finding>,
    /// Pictures, the most telling first.
    pub figures: Vec<Figure>,
}

//! Results of a log, however it was recorded: what report, joint file and JSON are made of.

use super::findings::Finding;
use report::plot::Figure;

/// Results of a log.
pub struct Results {
    /// Length of the log [s].
    pub duration: f64,
    /// Crossings of the gap.
    pub crossings: usize,
    /// Assumptions that the numbers rest on.
    pub assumptions: Vec<String>,
    /// Parameters, each with its interval or why it has none.
    pub findings: Vec<Finding>,
    /// Pictures, first the most telling.
    pub figures: Vec<Figure>,
}

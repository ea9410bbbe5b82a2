//! Checks: a figure, its bound and the resulting verdict.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::failure::{Failure, Outcome};

/// One row of the table of checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Check {
    /// Subject of the check, as a sentence or noun phrase.
    pub name: String,
    /// Value of the figure; absent if not available.
    pub figure: Option<f64>,
    /// Unit of figure and bound; empty for counts.
    pub unit: String,
    /// Bound of the figure.
    pub bound: Bound,
    /// Verdict of the check.
    pub verdict: Verdict,
    /// Source of the figure.
    pub source: Source,
    /// Basis of the figure, or remedy for a failure; may be empty.
    pub note: String,
}

/// Bound of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// figure <= bound
    AtMost(f64),
    /// figure >= bound
    AtLeast(f64),
    /// figure = bound
    Exactly(f64),
    /// No bound: the figure is only reported.
    None,
}

/// Verdict of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within its bound.
    Passed,
    /// Outside its bound, or not a number.
    Failed,
    /// Not applicable, or the run ended too early; the note gives the reason.
    NotRun,
    /// A figure without a bound.
    Reported,
}

/// Source of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Measured by the board; marked EMULATED for the emulated board.
    Board,
    /// Read from the image.
    Image,
    /// Computed on the host.
    Host,
}

impl Bound {
    /// Returns true if a figure keeps the bound; a NaN keeps no bound.
    pub fn holds(self, figure: f64) -> bool {
        match self {
            Self::AtMost(bound) => figure <= bound,
            Self::AtLeast(bound) => figure >= bound,
            Self::Exactly(bound) => figure == bound,
            Self::None => true,
        }
    }

    /// Sign and value of the bound, if there is one.
    pub fn sign_and_value(self) -> Option<(&'static str, f64)> {
        match self {
            Self::AtMost(bound) => Some(("≤", bound)),
            Self::AtLeast(bound) => Some(("≥", bound)),
            Self::Exactly(bound) => Some(("=", bound)),
            Self::None => None,
        }
    }
}

impl Check {
    /// Check whose verdict follows from figure and bound.
    pub fn new(name: impl Into<String>, figure: f64, unit: impl Into<String>, bound: Bound, source: Source) -> Self {
        let verdict = match bound {
            Bound::None => Verdict::Reported,
            _ if bound.holds(figure) => Verdict::Passed,
            _ => Verdict::Failed,
        };
        let (name, unit) = (name.into(), unit.into());
        Self { name, figure: Some(figure), unit, bound, verdict, source, note: String::new() }
    }

    /// Check that could not be made, with the reason.
    pub fn not_run(name: impl Into<String>, unit: impl Into<String>, bound: Bound, why: impl Into<String>) -> Self {
        let (name, unit, note) = (name.into(), unit.into(), why.into());
        Self { name, figure: None, unit, bound, verdict: Verdict::NotRun, source: Source::Host, note }
    }

    /// Adds a note to the check.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }
}

/// Fails if any check failed, and names the failed checks.
pub fn all_hold(checks: &[Check], help: &str) -> Outcome<()> {
    let failed = checks.iter().filter(|check| check.verdict == Verdict::Failed);
    let failed: Vec<&str> = failed.map(|check| check.name.as_str()).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let message = format!("{} of {} checks did not hold: {}", failed.len(), checks.len(), failed.join(", "));
    Err(Failure::check_failed(message).with_help(help))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_fails_every_bound() {
        for bound in [Bound::AtMost(1.0), Bound::AtLeast(1.0), Bound::Exactly(1.0)] {
            assert_eq!(Check::new("error", f64::NAN, "%", bound, Source::Host).verdict, Verdict::Failed);
        }
    }

    #[test]
    fn bound_itself_passes() {
        assert_eq!(Check::new("overruns", 0.0, "", Bound::Exactly(0.0), Source::Board).verdict, Verdict::Passed);
        assert_eq!(Check::new("error", 1.0, "%", Bound::AtMost(1.0), Source::Host).verdict, Verdict::Passed);
        assert_eq!(Check::new("steps", 1e5, "", Bound::AtLeast(1e5), Source::Host).verdict, Verdict::Passed);
        assert_eq!(Check::new("error", 1.01, "%", Bound::AtMost(1.0), Source::Host).verdict, Verdict::Failed);
    }

    #[test]
    fn unbounded_figure_is_reported() {
        assert_eq!(Check::new("idle", 40.0, "%", Bound::None, Source::Board).verdict, Verdict::Reported);
    }
}

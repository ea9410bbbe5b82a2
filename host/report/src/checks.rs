//! Checks: a figure, its bound and the resulting verdict.

use serde::{Deserialize, Serialize};

use crate::failure::{Failure, Outcome};

/// One line of the table of checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Check {
    /// What was checked, as a sentence or noun phrase.
    pub name: String,
    /// The figure; absent if it could not be had.
    pub figure: Option<f64>,
    /// Unit of figure and bound, empty for counts.
    pub unit: String,
    /// What the figure must keep to.
    pub bound: Bound,
    /// What came of it.
    pub verdict: Verdict,
    /// Where the figure comes from.
    pub source: Source,
    /// What it rests on, or what to do about a failure; may be empty.
    pub note: String,
}

/// What a figure must keep to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// figure <= bound
    AtMost(f64),
    /// figure >= bound
    AtLeast(f64),
    /// figure = bound
    Exactly(f64),
    /// Reported only: never fails.
    None,
}

/// What came of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within its bound.
    Passed,
    /// Outside its bound, or not a number.
    Failed,
    /// It did not apply, or the run ended before it could be made; the note says why.
    NotRun,
    /// A figure without a bound.
    Reported,
}

/// Where a figure comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Measured by the board; marked EMULATED when the board was.
    Board,
    /// Read off the image.
    Image,
    /// Computed on the host.
    Host,
}

impl Bound {
    /// Whether a figure keeps to the bound; a NaN keeps to none.
    pub fn holds(self, figure: f64) -> bool {
        match self {
            Self::AtMost(bound) => figure <= bound,
            Self::AtLeast(bound) => figure >= bound,
            Self::Exactly(bound) => figure == bound,
            Self::None => true,
        }
    }

    /// Its sign and what stands behind it; nothing if there is no bound.
    pub fn in_signs(self) -> Option<(&'static str, f64)> {
        match self {
            Self::AtMost(bound) => Some(("≤", bound)),
            Self::AtLeast(bound) => Some(("≥", bound)),
            Self::Exactly(bound) => Some(("=", bound)),
            Self::None => None,
        }
    }
}

impl Check {
    /// A check whose verdict follows from figure and bound.
    pub fn judge(name: impl Into<String>, figure: f64, unit: impl Into<String>, bound: Bound, source: Source) -> Self {
        let verdict = match bound {
            Bound::None => Verdict::Reported,
            _ if bound.holds(figure) => Verdict::Passed,
            _ => Verdict::Failed,
        };
        let (name, unit) = (name.into(), unit.into());
        Self { name, figure: Some(figure), unit, bound, verdict, source, note: String::new() }
    }

    /// A check that could not be made, and why.
    pub fn not_run(name: impl Into<String>, unit: impl Into<String>, bound: Bound, why: impl Into<String>) -> Self {
        let (name, unit, note) = (name.into(), unit.into(), why.into());
        Self { name, figure: None, unit, bound, verdict: Verdict::NotRun, source: Source::Host, note }
    }

    /// The same check with a remark.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }
}

/// Succeeds only if no check has failed; names those that have.
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
    fn a_figure_that_is_not_a_number_fails_every_bound() {
        for bound in [Bound::AtMost(1.0), Bound::AtLeast(1.0), Bound::Exactly(1.0)] {
            assert_eq!(Check::judge("error", f64::NAN, "%", bound, Source::Host).verdict, Verdict::Failed);
        }
    }

    #[test]
    fn the_bound_itself_is_still_within() {
        assert_eq!(Check::judge("overruns", 0.0, "", Bound::Exactly(0.0), Source::Board).verdict, Verdict::Passed);
        assert_eq!(Check::judge("error", 1.0, "%", Bound::AtMost(1.0), Source::Host).verdict, Verdict::Passed);
        assert_eq!(Check::judge("steps", 1e5, "", Bound::AtLeast(1e5), Source::Host).verdict, Verdict::Passed);
        assert_eq!(Check::judge("error", 1.01, "%", Bound::AtMost(1.0), Source::Host).verdict, Verdict::Failed);
    }

    #[test]
    fn a_figure_without_a_bound_is_only_reported() {
        assert_eq!(Check::judge("idle", 40.0, "%", Bound::None, Source::Board).verdict, Verdict::Reported);
    }
}

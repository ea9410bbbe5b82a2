//! Reason for the early end of a run.

use std::fmt;

use report::failure::Failure;

/// Reason for the early end of a run.
#[derive(Debug)]
pub enum RunError {
    /// The run cannot begin.
    Refused(Failure),
    /// Plant or controller gave a number that is not finite: a failure of the tested controller.
    Broke(String),
    /// The test's time on the clock was up.
    TimedOut,
    /// The user stopped the run.
    Interrupted,
}

impl fmt::Display for RunError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(failure) => formatter.write_str(failure.message()),
            Self::Broke(why) => formatter.write_str(why),
            Self::TimedOut => formatter.write_str("the test's time on the clock was up"),
            Self::Interrupted => formatter.write_str("stopped by the user"),
        }
    }
}

impl From<Failure> for RunError {
    fn from(failure: Failure) -> Self {
        Self::Refused(failure)
    }
}

//! Why a run ended early.

use std::fmt;

use report::failure::Failure;

/// Why a run ended early.
#[derive(Debug)]
pub enum RunError {
    /// It cannot even begin.
    Refused(Failure),
    /// Plant or controller left what is finite: a fault of what is tested.
    Broke(String),
    /// The test's time on the clock was up.
    TimedOut,
    /// By the user.
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

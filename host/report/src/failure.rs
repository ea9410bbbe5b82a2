//! Error for the user: cause, remedy, and exit code.

use std::fmt;
use std::io::{self, Write};

use crate::escape::escaped;

/// Exit code of a run with a failed check.
pub const EXIT_CHECK_FAILED: u8 = 1;
/// Exit code of bad input or of an unusable environment.
pub const EXIT_BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C: 128 + SIGINT.
pub const EXIT_INTERRUPTED: u8 = 130;

/// Error of a command.
#[derive(Debug)]
pub struct Failure {
    message: String,
    help: Option<String>,
    report: Option<miette::Report>,
    exit_code: u8,
}

/// Problem at a place of a source text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line, from one.
    pub line: usize,
    /// Column, from one [letters].
    pub column: usize,
    /// Problem in one sentence.
    pub message: String,
    /// Remedy.
    pub help: Option<String>,
}

/// Result whose error is shown to the user.
pub type Outcome<T> = Result<T, Failure>;

impl Failure {
    /// Error of bad input or a bad environment (exit code 2). The message names the culprit.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, report: None, exit_code: EXIT_BAD_INPUT }
    }

    /// Error of a failed check (exit code 1).
    pub fn check_failed(message: impl Into<String>) -> Self {
        Self { exit_code: EXIT_CHECK_FAILED, ..Self::new(message) }
    }

    /// Interruption by the user (exit code 130).
    pub fn interrupted(message: impl Into<String>) -> Self {
        Self { exit_code: EXIT_INTERRUPTED, ..Self::new(message) }
    }

    /// Error with a diagnostic that underlines places in a source text (exit code 2). The message lists the problems
    /// without the text.
    pub fn from_report(report: miette::Report) -> Self {
        let places: Vec<String> = report.related().into_iter().flatten().map(|place| place.to_string()).collect();
        let message = if places.is_empty() { report.to_string() } else { format!("{report}: {}", places.join("; ")) };
        Self { report: Some(report), ..Self::new(message) }
    }

    /// Adds the remedy.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Prefixes the message with the failed activity.
    #[must_use]
    pub fn while_doing(mut self, what: impl fmt::Display) -> Self {
        self.message = format!("{what}: {}", self.message);
        self
    }

    /// Cause of the error.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Remedy.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Remedy, or those of all places of a diagnostic.
    pub fn full_help(&self) -> Option<String> {
        let places = self.report.iter().flat_map(|report| report.related().into_iter().flatten());
        let of_places: Vec<String> = places.filter_map(|place| Some(place.help()?.to_string())).collect();
        self.help.clone().or_else(|| (!of_places.is_empty()).then(|| of_places.join("; ")))
    }

    /// Problems with their places in the source text; empty unless the failure has a drawn diagnostic.
    pub fn places(&self) -> Vec<Place> {
        let Some(report) = &self.report else { return Vec::new() };
        let place = |problem: &dyn miette::Diagnostic| {
            let label = problem.labels()?.next()?;
            let found = report.source_code()?.read_span(label.inner(), 0, 0).ok()?;
            Some(Place {
                line: found.line() + 1,
                column: found.column() + 1,
                message: problem.to_string(),
                help: problem.help().map(|help| help.to_string()),
            })
        };
        report.related().into_iter().flatten().filter_map(place).collect()
    }

    /// Exit code of the process.
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }

    /// Prints the failure on standard error; a closed pipe is ignored.
    pub fn show(&self) {
        let _ = writeln!(io::stderr().lock(), "{self}");
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.report {
            Some(report) => write!(f, "{report:?}")?,
            None => write!(f, "error: {}", escaped(&self.message))?,
        }
        match &self.help {
            Some(help) => write!(f, "\n  help: {}", escaped(help).replace('\n', "\n        ")),
            None => Ok(()),
        }
    }
}

impl From<miette::Report> for Failure {
    fn from(report: miette::Report) -> Self {
        Self::from_report(report)
    }
}

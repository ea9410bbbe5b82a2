//! The one error that reaches a user: what is wrong, what to do about it, and the exit code.

use std::fmt;
use std::io::{self, Write};

use crate::escape::escaped;

/// Exit code of a run whose checks did not all hold.
pub const EXIT_CHECK_FAILED: u8 = 1;
/// Exit code of bad input or of an environment that cannot be worked with.
pub const EXIT_BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C: 128 + SIGINT.
pub const EXIT_INTERRUPTED: u8 = 130;

/// The error of a command.
#[derive(Debug)]
pub struct Failure {
    message: String,
    help: Option<String>,
    report: Option<miette::Report>,
    exit_code: u8,
}

/// Result of everything whose error is shown to the user.
pub type Outcome<T> = Result<T, Failure>;

impl Failure {
    /// Bad input or a bad environment (exit code 2). The message names the culprit.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, report: None, exit_code: EXIT_BAD_INPUT }
    }

    /// A check that did not hold (exit code 1).
    pub fn check_failed(message: impl Into<String>) -> Self {
        Self { exit_code: EXIT_CHECK_FAILED, ..Self::new(message) }
    }

    /// Stopped by the user (exit code 130).
    pub fn interrupted(message: impl Into<String>) -> Self {
        Self { exit_code: EXIT_INTERRUPTED, ..Self::new(message) }
    }

    /// A diagnostic that underlines the places in a source text (exit code 2). Its message tells them without the text.
    pub fn from_report(report: miette::Report) -> Self {
        let places: Vec<String> = report.related().into_iter().flatten().map(|place| place.to_string()).collect();
        let message = if places.is_empty() { report.to_string() } else { format!("{report}: {}", places.join("; ")) };
        Self { report: Some(report), ..Self::new(message) }
    }

    /// Adds the help: what to do about it.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Puts what was being done in front of the message.
    #[must_use]
    pub fn while_doing(mut self, what: impl fmt::Display) -> Self {
        self.message = format!("{what}: {}", self.message);
        self
    }

    /// What is wrong.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The help: what to do about it.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The help, or that of every place of a diagnostic.
    pub fn full_help(&self) -> Option<String> {
        let places = self.report.iter().flat_map(|report| report.related().into_iter().flatten());
        let of_places: Vec<String> = places.filter_map(|place| Some(place.help()?.to_string())).collect();
        self.help.clone().or_else(|| (!of_places.is_empty()).then(|| of_places.join("; ")))
    }

    /// The process's exit code.
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }

    /// Shows the failure on standard error; a reader that has gone away is no further error.
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

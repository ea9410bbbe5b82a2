//! One problem in a joint file: where, what, and the help.

use std::ops::Range;

/// One problem of a joint file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Bytes of the text that the problem is about.
    pub span: Range<usize>,
    /// What is wrong, in one sentence.
    pub message: String,
    /// The help: what to do about it.
    pub help: String,
    /// Whether the file can be used all the same.
    pub severity: Severity,
}

/// How bad a problem is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file is used as it stands.
    Warning,
}

impl std::fmt::Display for Problem {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{} ({})", self.message, self.help)
    }
}

//! Problem of a joint file: place, message and help.

use std::ops::Range;

/// Problem of a joint file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Place in the text [bytes].
    pub span: Range<usize>,
    /// Problem in one sentence.
    pub message: String,
    /// Remedy.
    pub help: String,
    /// Severity: an error, or a warning for a usable file.
    pub severity: Severity,
}

/// Severity of a problem.
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

/// All problems of a file, each with its place, in order of the text.
///
/// ```
/// fn name(text: &str) -> Result<String, Box<dyn std::error::Error>> {
///     Ok(joint_file::read(text)?.parameters.name.to_string())
/// }
/// let said = name("stiffness = 1").unwrap_err().to_string();
/// assert!(said.contains("`stiffness`"), "{said}");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Problems(pub Vec<Problem>);

impl std::ops::Deref for Problems {
    type Target = [Problem];

    fn deref(&self) -> &[Problem] {
        &self.0
    }
}

impl IntoIterator for Problems {
    type Item = Problem;
    type IntoIter = std::vec::IntoIter<Problem>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl From<Vec<Problem>> for Problems {
    fn from(problems: Vec<Problem>) -> Self {
        Self(problems)
    }
}

/// One problem per line.
impl std::fmt::Display for Problems {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, problem) in self.0.iter().enumerate() {
            let separator = if index > 0 { "\n" } else { "" };
            write!(formatter, "{separator}{problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}

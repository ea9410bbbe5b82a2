//! Draws what is wrong with a file that users write: every problem at once, each with its place underlined. Colours and line
//! drawing follow the terminal, as miette decides.

use std::error::Error;
use std::fmt;

use crate::{Problem, Severity};
use miette::{Diagnostic, LabeledSpan, NamedSource, Report};

/// A file with all its problems.
#[derive(Debug)]
struct Rejected {
    name: String,
    source: NamedSource<String>,
    places: Vec<Place>,
}

/// One problem.
#[derive(Debug)]
struct Place(Problem);

/// One report over all problems of the file called `name`.
///
/// ```
/// let text = joint_file::preset("q1").unwrap().replace("planets = 3", "planets = 7");
/// let problems = joint_file::read(&text).unwrap_err();
/// let shown = format!("{:?}", joint_file::diagnostic::report("my_joint.toml", &text, &problems));
/// // The place with its line, what is wrong and what to do about it.
/// assert!(shown.contains("my_joint.toml") && shown.contains("planets = 7"), "{shown}");
/// assert!(shown.contains("3, 4 or 5") || shown.contains("3 to 5"), "{shown}");
/// ```
pub fn report(name: &str, text: &str, problems: &[Problem]) -> Report {
    Report::new(Rejected {
        name: name.to_owned(),
        source: NamedSource::new(name, text.to_owned()),
        places: problems.iter().cloned().map(Place).collect(),
    })
}

impl fmt::Display for Rejected {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let errors = self.places.iter().filter(|place| place.0.severity == Severity::Error).count();
        let count = if errors == 1 { "one problem".to_owned() } else { format!("{errors} problems") };
        write!(formatter, "{} cannot be used: {count}", self.name)
    }
}

impl Error for Rejected {}

impl Diagnostic for Rejected {
    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        Some(&self.source)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.places.iter().map(|place| place as &dyn Diagnostic)))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0.message)
    }
}

impl Error for Place {}

impl Diagnostic for Place {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.0.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.0.help))
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(LabeledSpan::underline(self.0.span.clone()))))
    }
}

//! Draws the problems of a user's file, all at once, each with its place underlined. Colours and line drawing follow
//! the terminal, as miette decides.

use std::borrow::Cow;
use std::error::Error;
use std::fmt;

use crate::notes::PROBLEMS_MAX;
use crate::{Problem, Severity};
use miette::{Diagnostic, LabeledSpan, NamedSource, Report};
use report::escape::{escaped, place_in_escaped};

/// A file with all its problems.
#[derive(Debug)]
struct Rejected {
    name: String,
    /// Text, if it can be drawn.
    source: Option<NamedSource<String>>,
    places: Vec<Place>,
}

/// Problem, with its line number if the text is not drawn.
#[derive(Debug)]
struct Place(Problem, Option<usize>);

/// Longest message beside a text that is not drawn [letters].
const MESSAGE_LETTERS_MAX: usize = 300;
/// Longest line that is drawn [bytes]: no terminal shows more, and drawing fails at 65,536 columns.
const LINE_BYTES_MAX: usize = 4096;

/// Report of all problems of the file called `name`.
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
    let drawn = text.split('\n').all(|line| line.len() <= LINE_BYTES_MAX);
    let line = |problem: &Problem| {
        let before = text.as_bytes().iter().take(problem.span.start);
        1 + before.filter(|byte| **byte == b'\n').count()
    };
    let place = |problem: &Problem| Place(shown(problem, text), (!drawn).then(|| line(problem)));
    let name = escaped(name);
    Report::new(Rejected {
        name: name.clone().into_owned(),
        source: drawn.then(|| NamedSource::new(name, escaped(text).into_owned())),
        places: problems.iter().map(place).collect(),
    })
}

/// Problem with escaped words, at its place in the escaped text.
fn shown(problem: &Problem, text: &str) -> Problem {
    let [start, end] = [problem.span.start, problem.span.end].map(|place| place_in_escaped(text, place));
    Problem {
        span: start..end,
        message: escaped(&problem.message).into_owned(),
        help: escaped(&problem.help).into_owned(),
        ..problem.clone()
    }
}

impl fmt::Display for Rejected {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let errors = self.places.iter().filter(|place| place.0.severity == Severity::Error).count();
        let count = match errors {
            1 => "one problem".to_owned(),
            _ if self.places.len() >= PROBLEMS_MAX => format!("{errors} problems, and there may be more"),
            _ => format!("{errors} problems"),
        };
        write!(formatter, "{} cannot be used: {count}", self.name)
    }
}

impl Error for Rejected {}

impl Diagnostic for Rejected {
    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.source.as_ref().map(|source| source as &dyn miette::SourceCode)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.places.iter().map(|place| place as &dyn Diagnostic)))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.1 {
            Some(line) => write!(formatter, "line {line}: {}", shortened(&self.0.message)),
            None => formatter.write_str(&self.0.message),
        }
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
        let drawn = self.1.is_none();
        Some(Box::new(drawn.then(|| LabeledSpan::underline(self.0.span.clone())).into_iter()))
    }
}

/// Message cut after the limit, as it may quote a very long word.
fn shortened(message: &str) -> Cow<'_, str> {
    match message.char_indices().nth(MESSAGE_LETTERS_MAX) {
        Some((end, _)) => format!("{} ...", &message[..end]).into(),
        None => message.into(),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn shown(text: &str) -> String {
        let problems = crate::read(text).expect_err("not a joint file");
        format!("{:?}", report("my_joint.toml", text, &problems))
    }

    /// A problem in a line too long to draw is reported with the line's number.
    #[test]
    fn long_line_is_reported_by_number() {
        let preset = crate::preset("q1").expect("a preset");
        let shown = shown(&format!("{preset}\n# {}\nnonsense_{} = 1\n", "x".repeat(70_000), "y".repeat(70_000)));
        let line = preset.lines().count() + 3;
        let plain = shown.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(plain.contains(&format!("line {line}: unknown key")), "{plain}");
        assert!(shown.len() < 5000, "{} letters", shown.len());
    }

    /// A file with very many problems is reported quickly, up to the limit.
    #[test]
    fn report_stops_at_problem_limit() {
        let unknown: String = (0..50_000).map(|number| format!("nonsense_{number} = 1\n")).collect();
        let broken = "a=\n".repeat(200_000);
        let (sender, receiver) = std::sync::mpsc::channel();
        std::thread::spawn(move || [unknown, broken].iter().try_for_each(|text| sender.send(shown(text))));
        for what in ["unknown", "broken"] {
            // Normally takes less than a second; a time proportional to the square of the file's length would be
            // minutes.
            let shown = receiver.recv_timeout(Duration::from_secs(30)).expect(what);
            assert!(shown.contains("100 problems, and there may be more"), "{what}: {shown}");
        }
    }
}

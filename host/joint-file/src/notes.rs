//! What is collected while a user's TOML file is read: problems, the place of each value, and what the file says about
//! the source of each number. Nothing here is specific to joints.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::problem::{Problem, Severity};

/// Where a number of a file comes from: the comment behind it, on its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The key with its section, as in `geometry.sun_teeth`.
    pub key: String,
    /// The comment behind the value; `None` if there is none.
    pub remark: Option<String>,
}

/// Begin of the comment behind a number that a program derived from others.
pub const DERIVED: &str = "derived from";

/// Problems of a file that are told: whoever mends so many runs the command again.
pub(crate) const MOST_PROBLEMS: usize = 100;

/// Problems and remarks, collected while the sections of one file are read.
pub struct Notes<'t> {
    text: &'t str,
    problems: RefCell<Vec<Problem>>,
    places: RefCell<BTreeMap<String, Range<usize>>>,
    sources: RefCell<Vec<Source>>,
}

impl<'t> Notes<'t> {
    /// Of the text of a file.
    pub fn new(text: &'t str) -> Self {
        Self { text, problems: RefCell::default(), places: RefCell::default(), sources: RefCell::default() }
    }

    /// Notes what keeps the file from being used.
    pub fn error(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.problem(span, message, help, Severity::Error);
    }

    /// Notes what is wrong, unless it has been.
    pub fn problem(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>, severity: Severity) {
        let problem = Problem { span, message: message.into(), help: help.into(), severity };
        let mut problems = self.problems.borrow_mut();
        // What stands in [mesh] is read once for each mesh family and would be reported twice.
        if problems.len() < MOST_PROBLEMS && !problems.contains(&problem) {
            problems.push(problem);
        }
    }

    /// Notes what the parser says of text that is no TOML.
    pub fn syntax(&self, error: &toml::de::Error) {
        let help = match error.message() {
            "duplicate key" => "leave one of the two out",
            _ => "write lines of the form key = value",
        };
        self.error(error.span().unwrap_or(self.top()), format!("not TOML: {}", error.message()), help);
    }

    /// No more problems are taken: there is no need to look for them.
    pub(crate) fn is_full(&self) -> bool {
        self.problems.borrow().len() == MOST_PROBLEMS
    }

    /// Whether anything keeps the file from being used.
    pub fn has_errors(&self) -> bool {
        self.problems.borrow().iter().any(|problem| problem.severity == Severity::Error)
    }

    /// Remembers where the value of `key` stands.
    pub fn place(&self, key: String, span: Range<usize>) {
        self.places.borrow_mut().insert(key, span);
    }

    /// Where the first of `keys` that the file holds has its value; the top of the file if it holds none.
    pub(crate) fn first_place(&self, keys: &[&str]) -> Range<usize> {
        let places = self.places.borrow();
        keys.iter().find_map(|key| places.get(*key)).cloned().unwrap_or(self.top())
    }

    /// The first of `keys` that the file holds, with the place of its value; the first of all, at the top of the file, if
    /// it holds none.
    pub(crate) fn first_held<'k>(&self, keys: &[&'k str]) -> (&'k str, Range<usize>) {
        let places = self.places.borrow();
        let held = keys.iter().find_map(|key| places.get(*key).map(|place| (*key, place.clone())));
        held.unwrap_or((keys.first().copied().unwrap_or_default(), self.top()))
    }

    /// Returns whether the file states a key, once it has been read.
    pub(crate) fn holds(&self, key: &str) -> bool {
        self.places.borrow().contains_key(key)
    }

    /// Origin of a number that a program derived, by the comment behind it: what follows on [`DERIVED`].
    pub(crate) fn derived_from(&self, key: &str) -> Option<String> {
        let sources = self.sources.borrow();
        let remark = sources.iter().find(|source| source.key == key)?.remark.as_deref()?;
        remark.strip_prefix(DERIVED).map(|from| from.trim().to_owned())
    }

    /// Remembers the comment behind a number.
    pub fn source(&self, key: String, value: &Range<usize>) {
        let mut sources = self.sources.borrow_mut();
        if sources.iter().any(|source| source.key == key) {
            return;
        }
        let rest = self.text[value.end..].lines().next().unwrap_or_default();
        let remark = rest.trim().strip_prefix('#').map(|comment| comment.trim().to_owned());
        sources.push(Source { key, remark: remark.filter(|remark| !remark.is_empty()) });
    }

    /// The first line that says anything: the place of what is missing from the file as a whole.
    pub fn top(&self) -> Range<usize> {
        let mut start = 0;
        for line in self.text.split_inclusive('\n') {
            let content = line.trim();
            if !content.is_empty() && !content.starts_with('#') {
                return start..start + line.trim_end().len();
            }
            start += line.len();
        }
        0..0
    }

    /// Problems in the order of the text, and sources in the order of reading.
    pub fn into_parts(self) -> (Vec<Problem>, Vec<Source>) {
        let mut problems = self.problems.into_inner();
        problems.sort_by_key(|problem| (problem.span.start, problem.span.end));
        (problems, self.sources.into_inner())
    }
}

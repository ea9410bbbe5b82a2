//! Notes of reading a user's TOML file: problems, the place of each value, and the stated source of each number.
//! Nothing here is specific to joints.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::problem::{Problem, Severity};

/// Source of a number: the comment behind it, on its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Key with its section, such as `geometry.sun_teeth`.
    pub key: String,
    /// The comment behind the value; `None` if there is none.
    pub remark: Option<String>,
}

/// Beginning of the comment behind a derived number.
pub const DERIVED: &str = "derived from";

/// Largest number of reported problems; a user who has fixed this many runs the command again.
pub(crate) const PROBLEMS_MAX: usize = 100;

/// Problems and remarks of one file, collected section by section.
pub struct Notes<'t> {
    text: &'t str,
    problems: RefCell<Vec<Problem>>,
    places: RefCell<BTreeMap<String, Range<usize>>>,
    sources: RefCell<Vec<Source>>,
}

impl<'t> Notes<'t> {
    /// Empty notes for the text of a file.
    pub fn new(text: &'t str) -> Self {
        Self { text, problems: RefCell::default(), places: RefCell::default(), sources: RefCell::default() }
    }

    /// Adds an error.
    pub fn error(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.problem(span, message, help, Severity::Error);
    }

    /// Adds a problem, once.
    pub fn problem(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>, severity: Severity) {
        let problem = Problem { span, message: message.into(), help: help.into(), severity };
        let mut problems = self.problems.borrow_mut();
        // [mesh] is read once per mesh family and would report its problems twice.
        if problems.len() < PROBLEMS_MAX && !problems.contains(&problem) {
            problems.push(problem);
        }
    }

    /// Adds a syntax error of the TOML parser.
    pub fn syntax(&self, error: &toml::de::Error) {
        let help = match error.message() {
            "duplicate key" => "leave one of the two out",
            _ => "write lines of the form key = value",
        };
        self.error(error.span().unwrap_or(self.top()), format!("not TOML: {}", error.message()), help);
    }

    /// Returns true once the limit of problems is reached.
    pub(crate) fn is_full(&self) -> bool {
        self.problems.borrow().len() == PROBLEMS_MAX
    }

    /// Returns true if any problem is an error.
    pub fn has_errors(&self) -> bool {
        self.problems.borrow().iter().any(|problem| problem.severity == Severity::Error)
    }

    /// Records the place of the value of `key`.
    pub fn place(&self, key: String, span: Range<usize>) {
        self.places.borrow_mut().insert(key, span);
    }

    /// Place of the value of the first of `keys` in the file; the top of the file without one.
    pub(crate) fn first_place(&self, keys: &[&str]) -> Range<usize> {
        let places = self.places.borrow();
        keys.iter().find_map(|key| places.get(*key)).cloned().unwrap_or(self.top())
    }

    /// First of `keys` in the file, with the place of its value; the first of all, at the top of the file, if none is
    /// stated.
    pub(crate) fn first_held<'k>(&self, keys: &[&'k str]) -> (&'k str, Range<usize>) {
        let places = self.places.borrow();
        let held = keys.iter().find_map(|key| places.get(*key).map(|place| (*key, place.clone())));
        held.unwrap_or((keys.first().copied().unwrap_or_default(), self.top()))
    }

    /// Returns true if the file states a key.
    pub(crate) fn holds(&self, key: &str) -> bool {
        self.places.borrow().contains_key(key)
    }

    /// Origin of a derived number: the comment behind [`DERIVED`].
    pub(crate) fn derived_from(&self, key: &str) -> Option<String> {
        let sources = self.sources.borrow();
        let remark = sources.iter().find(|source| source.key == key)?.remark.as_deref()?;
        remark.strip_prefix(DERIVED).map(|from| from.trim().to_owned())
    }

    /// Records the comment behind a number.
    pub fn source(&self, key: String, value: &Range<usize>) {
        let mut sources = self.sources.borrow_mut();
        if sources.iter().any(|source| source.key == key) {
            return;
        }
        let rest = self.text[value.end..].lines().next().unwrap_or_default();
        let remark = rest.trim().strip_prefix('#').map(|comment| comment.trim().to_owned());
        sources.push(Source { key, remark: remark.filter(|remark| !remark.is_empty()) });
    }

    /// First line with content: the place of problems of the whole file.
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

//! Known defects of the images that are not fixed yet. They do not fail a check; a fixed one must leave this list, or
//! the run of all checks fails.

use std::collections::BTreeSet;
use std::sync::Mutex;

use crate::violation::Violation;

/// Known violations: board, part of the text, and consequence.
const VIOLATIONS: &[(&str, &str, &str)] = &[];

/// Checks known to fail: board, part of the check's name, and consequence.
const CHECKS: &[(&str, &str, &str)] = &[];

static SEEN: Mutex<BTreeSet<usize>> = Mutex::new(BTreeSet::new());

/// Returns whether a violation is known, and records that it was seen.
pub fn is_known(board: &str, violation: &Violation) -> bool {
    let place = VIOLATIONS.iter().position(|(name, text, _)| *name == board && violation.what.contains(text));
    if let (Some(place), Ok(mut seen)) = (place, SEEN.lock()) {
        seen.insert(place);
    }
    place.is_some()
}

/// Consequence of a check that is known to fail.
pub fn failing(board: &str, check: &str) -> Option<&'static str> {
    CHECKS.iter().find(|(name, text, _)| *name == board && check.contains(text)).map(|(.., follows)| *follows)
}

/// Known violations that no check has met, and those that were met.
pub fn violations() -> (Vec<String>, Vec<String>) {
    let seen = SEEN.lock().map(|seen| seen.clone()).unwrap_or_default();
    let line = |(board, what, follows): &(&str, &str, &str)| format!("{board}: {what}: {follows}");
    let (met, missed): (Vec<_>, Vec<_>) = VIOLATIONS.iter().enumerate().partition(|(place, _)| seen.contains(place));
    (
        missed.into_iter().map(|(_, known)| line(known)).collect(),
        met.into_iter().map(|(_, known)| line(known)).collect(),
    )
}

//! Defects of the images that are known and not mended yet. They do not fail a check; one that is mended must leave this list,
//! or the check of everything fails.

use std::collections::BTreeSet;
use std::sync::Mutex;

use crate::violation::Violation;

/// Rules that are broken: board, part of what is said, and what follows from it.
const VIOLATIONS: &[(&str, &str, &str)] = &[];

/// Checks that fail: board, part of the check's name, and what follows from it.
const CHECKS: &[(&str, &str, &str)] = &[];

static SEEN: Mutex<BTreeSet<usize>> = Mutex::new(BTreeSet::new());

/// Whether a violation is known; remembers that it was seen.
pub fn is_known(board: &str, violation: &Violation) -> bool {
    let place = VIOLATIONS.iter().position(|(name, text, _)| *name == board && violation.what.contains(text));
    if let (Some(place), Ok(mut seen)) = (place, SEEN.lock()) {
        seen.insert(place);
    }
    place.is_some()
}

/// What follows from a check that is known to fail.
pub fn failing(board: &str, check: &str) -> Option<&'static str> {
    CHECKS.iter().find(|(name, text, _)| *name == board && check.contains(text)).map(|(.., follows)| *follows)
}

/// Known violations that no check has met, and those that one has.
pub fn violations() -> (Vec<String>, Vec<String>) {
    let seen = SEEN.lock().map(|seen| seen.clone()).unwrap_or_default();
    let line = |(board, what, follows): &(&str, &str, &str)| format!("{board}: {what}: {follows}");
    let (met, missed): (Vec<_>, Vec<_>) = VIOLATIONS.iter().enumerate().partition(|(place, _)| seen.contains(place));
    (
        missed.into_iter().map(|(_, known)| line(known)).collect(),
        met.into_iter().map(|(_, known)| line(known)).collect(),
    )
}

//! Problems of joint files: each case asserts message, underlined text and help. Every case is Q1's file with one
//! change, which is therefore the only cause.

mod gears;
mod keys;
mod meshes;
mod values;

use joint_file::{Problem, Severity, preset, read};

/// Q1's file with one piece of text replaced.
fn spoilt(from: &str, to: &str) -> String {
    let text = preset("q1").expect("a preset");
    assert_eq!(text.matches(from).count(), 1, "`{from}` is not in the file exactly once");
    text.replace(from, to)
}

fn problems(text: &str) -> Vec<Problem> {
    read(text).expect_err("the file is spoilt").0
}

/// Returns message, underlined text and help of the only problem of a file.
fn only(text: &str) -> (String, String, String) {
    let problems = problems(text);
    assert_eq!(problems.len(), 1, "{problems:#?}");
    let Problem { span, message, help, severity } = problems[0].clone();
    assert_eq!(severity, Severity::Error);
    (message, text[span].to_owned(), help)
}

/// Asserts message and underlined text of the only problem, and that its help contains `wanted`.
#[track_caller]
fn refused(text: &str, message: &str, underlined: &str, wanted: &str) {
    let (found, place, help) = only(text);
    assert_eq!((found.as_str(), place.as_str()), (message, underlined));
    assert!(help.contains(wanted), "`{wanted}` is not in `{help}`");
}

//! Output of a command: results on standard output or in a file, remarks on standard error. A closed pipe is not an
//! error.

use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use serde::Serialize;

use crate::escape::{escaped, escaped_json};
use crate::failure::{Failure, Outcome};
use crate::folder;
use crate::write::{is_standard_output, record_into, write_record, write_text};

/// Verdicts that are printed in red.
const FAILURE_WORDS: [&str; 3] = ["FAILED", "BROKEN", "NOT RUN"];
/// Escape sequences for bold red and for its end.
const RED: &str = "\u{1b}[1;31m";
const PLAIN: &str = "\u{1b}[0m";

/// True if standard output is reserved for JSON.
static FOR_JSON: AtomicBool = AtomicBool::new(false);

/// Reserves standard output for JSON if the JSON goes there; later prints go to standard error.
pub fn keep_for_json(wanted: Option<&Path>) {
    if wanted.is_some_and(is_standard_output) {
        FOR_JSON.store(true, Ordering::Relaxed);
    }
}

/// True if results are not printed.
static SILENT: AtomicBool = AtomicBool::new(false);

/// Prints no results and remarks from now on: a library returns them.
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Prints a result on standard output, or on standard error if standard output is reserved for JSON. Failures are red
/// on a terminal.
pub fn print(text: &str) -> Outcome<()> {
    if SILENT.load(Ordering::Relaxed) {
        return Ok(());
    }
    if FOR_JSON.load(Ordering::Relaxed) {
        let text = on(&io::stderr(), text);
        // A closed pipe is ignored.
        let _ = io::stderr().lock().write_all(text.as_bytes());
        return Ok(());
    }
    print_out(&on(&io::stdout(), text))
}

/// Returns a text for a stream: escaped, and coloured on a terminal with colours unless NO_COLOR or a similar variable
/// forbids it.
pub fn on<'t>(stream: &impl RawStream, text: &'t str) -> Cow<'t, str> {
    let text = escaped(text);
    match AutoStream::choice(stream) {
        ColorChoice::Never => text,
        _ => Cow::Owned(with_failures_in_red(&text)),
    }
}

/// Colours bad verdicts at the beginning of a line.
fn with_failures_in_red(text: &str) -> String {
    let line = |line: &str| match FAILURE_WORDS.iter().find(|word| line.starts_with(**word)) {
        Some(word) => format!("{RED}{word}{PLAIN}{}", &line[word.len()..]),
        None => line.to_owned(),
    };
    text.split_inclusive('\n').map(line).collect()
}

/// Writes JSON to a file; "-" is standard output.
pub fn write_json(file: &Path, json: &str) -> Outcome<()> {
    if is_standard_output(file) { print_out(&escaped_json(json)) } else { write_text(file, json) }
}

/// Writes a record as JSON in one line to a file; "-" is standard output.
pub fn write_json_record(file: &Path, record: &impl Serialize) -> Outcome<()> {
    if !is_standard_output(file) {
        return write_record(file, record);
    }
    let mut line = Vec::new();
    record_into(&mut line, record)
        .map_err(|error| Failure::new(format!("cannot write the record as JSON: {error}")))?;
    print_out(&escaped_json(&String::from_utf8_lossy(&line)))
}

fn print_out(text: &str) -> Outcome<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Record as indented JSON; `what` names it in an error.
pub fn json(what: &str, record: &impl Serialize) -> Outcome<String> {
    serde_json::to_string_pretty(record)
        .map(|json| json + "\n")
        .map_err(|error| Failure::new(format!("the {what} cannot be written as JSON: {error}")))
}

/// Prints figures as text on standard output, and writes them as JSON to the wanted file; "-" is standard output, in
/// place of the text. `read` are the input files.
pub fn deliver(figures: &impl Serialize, text: &str, wanted: Option<&Path>, read: &[&Path]) -> Outcome<()> {
    folder::check_files(&[("json", wanted)], read)?;
    if let Some(path) = wanted {
        write_json(path, &json("figures", figures)?)?;
        if is_standard_output(path) {
            return Ok(());
        }
    }
    print(text)
}

/// Prints a remark on standard error; a closed pipe is ignored.
pub fn remark(text: &str) {
    if SILENT.load(Ordering::Relaxed) {
        return;
    }
    let _ = writeln!(io::stderr().lock(), "{}", escaped(text));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_failures_are_red() {
        let shown = with_failures_in_red("ok       a\nFAILED   b FAILED\n         FAILED\nBROKEN   c\n");
        let red = |word: &str| format!("\u{1b}[1;31m{word}\u{1b}[0m");
        assert_eq!(
            shown,
            format!("ok       a\n{}   b FAILED\n         FAILED\n{}   c\n", red("FAILED"), red("BROKEN"))
        );
    }
}

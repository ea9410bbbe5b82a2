//! Output of a command: results on standard output or in a file, remarks on standard error. A closed pipe is not an
//! error.

use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::folder;
use crate::write::write_text;

/// Prints a result on standard output.
pub fn print(text: &str) -> Outcome<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// A record as JSON for people and programs; `what` names it if that cannot be.
pub fn json(what: &str, record: &impl Serialize) -> Outcome<String> {
    serde_json::to_string_pretty(record)
        .map(|json| json + "\n")
        .map_err(|error| Failure::new(format!("the {what} cannot be written as JSON: {error}")))
}

/// Gives out figures: as text on standard output, and as JSON in the file that is asked for; "-" is standard output, in
/// place of the text. `read` is what they were made from.
pub fn deliver(figures: &impl Serialize, text: &str, wanted: Option<&Path>, read: &[&Path]) -> Outcome<()> {
    folder::check_files(&[("json", wanted)], read)?;
    if let Some(path) = wanted {
        let json = json("figures", figures)?;
        if path.as_os_str() == "-" {
            return print(&json);
        }
        write_text(path, &json)?;
    }
    print(text)
}

/// Prints a remark on standard error, as far as anyone listens.
pub fn remark(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

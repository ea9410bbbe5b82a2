//! What the command gives out: results on standard output or in a file, remarks on standard error. A reader that has gone away is no
//! error; progress lines are made elsewhere.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::folder;

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
        fs::write(path, json).map_err(|error| {
            Failure::new(format!("cannot write {}: {error}", path.display()))
                .with_help("name a file in a folder that exists and can be written to")
        })?;
    }
    print(text)
}

/// A number as one would type it: whole ones without a point, very large and very small ones by their power of ten.
pub fn typed(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() || (1e-6..1e15).contains(&size) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Prints a remark on standard error, as far as anyone listens.
pub fn remark(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::typed;

    #[test]
    fn numbers_are_told_as_one_would_type_them() {
        let told = [0.0, -1.0, 0.25, 1e308, 1e-300, f64::NAN].map(typed);
        assert_eq!(told, ["0", "-1", "0.25", "1e308", "1e-300", "NaN"]);
    }
}

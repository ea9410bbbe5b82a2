//! `joint check`: reads a joint file and prints what follows from it, or everything that is wrong with it. Nothing is
//! run here.
//!
//! `source` finds and reads the file, `diagnostic` draws what is wrong, `derive` computes the `figures`, `step` asks the design for
//! the fixed step, `layout` prints.

mod derive;
pub(crate) mod diagnostic;
mod figures;
mod layout;
mod source;
mod step;
#[cfg(test)]
mod tests;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};
pub use derive::figures;
pub use figures::Figures;
pub use layout::{Page, layout};
pub use source::{Loaded, load, load_with, read_changed};

/// Arguments of `joint check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, paper, paper_printed
    #[arg(default_value = "q1", value_name = "FILE")]
    pub file: PathBuf,
    /// Writes the same figures as JSON ("-" is standard output, in place of the text)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
    /// Steps a second for which the tables are designed
    #[arg(long, value_name = "HZ", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: u32,
}

/// Prints what follows from the file.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let loaded = load(&arguments.file)?;
    let figures = figures(&loaded, arguments.rate)?;
    match &arguments.json {
        Some(out) if out.as_os_str() == "-" => return print(&json(&figures)?),
        Some(out) => save(&figures, out)?,
        None => {}
    }
    print(&layout(&figures))
}

fn json(figures: &Figures) -> Outcome<String> {
    serde_json::to_string_pretty(figures)
        .map(|json| json + "\n")
        .map_err(|error| Failure::new(format!("the figures cannot be written as JSON: {error}")))
}

fn save(figures: &Figures, out: &Path) -> Outcome<()> {
    fs::write(out, json(figures)?).map_err(|error| {
        Failure::new(format!("cannot write {}: {error}", out.display()))
            .with_help("name a file in a folder that exists and can be written to")
    })
}

/// A reader that has gone away is no error.
fn print(text: &str) -> Outcome<()> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::new(format!("no output: {error}"))),
        _ => Ok(()),
    }
}

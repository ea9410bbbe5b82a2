//! `joint check`: what follows from a joint file. Nothing is run here.

use std::path::PathBuf;

use crate::failure::Outcome;

/// Arguments of `joint check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset such as q1
    #[arg(default_value = "q1")]
    pub file: PathBuf,
}

/// Prints what follows from the file.
pub fn run(_arguments: &Arguments) -> Outcome<()> {
    Ok(())
}

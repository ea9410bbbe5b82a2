//! `joint check`: reads a joint file and prints what follows from it, or everything that is wrong with it.

use std::path::PathBuf;

use joint_file::named;
use report::failure::Outcome;
use report::output;
use simulation::check::{layout, summary};

/// Arguments of `joint check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
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
    let loaded = named::load(&arguments.file)?;
    let summary = summary(&loaded, arguments.rate)?;
    output::deliver(&summary, &layout(&summary), arguments.json.as_deref(), &[&arguments.file])
}

//! `joint check`: reads a joint file and prints the derived quantities, or reports every error in the file.

use std::path::PathBuf;

use board::device::board::Board;
use joint_file::named;
use report::failure::Outcome;
use report::output;
use report::progress::Progress;
use simulation::check::{layout, summary};
use simulation::verdicts::DEFAULT_ACCURACY;

use crate::budget::parse_accuracy;

/// Arguments of `joint check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(default_value = "q1", value_name = "FILE")]
    pub file: PathBuf,
    /// Writes the figures as JSON ("-": to standard output, in place of the text)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
    /// Board that the tables are designed for: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    pub board: Board,
    /// Step rate in Hz that the tables are designed for
    #[arg(long, value_name = "HZ", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: u32,
    /// Largest acceptable error: deflections, gap and link on the reversals, over the motion's standard deviation
    #[arg(long, value_name = "E", value_parser = parse_accuracy, default_value_t = DEFAULT_ACCURACY)]
    pub accuracy: f64,
}

/// Prints the derived quantities of the joint.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let loaded = named::load(&arguments.file)?;
    let progress = Progress::new();
    progress.stage("measuring the error");
    let summary = summary(&loaded, &arguments.board, arguments.rate, Some(arguments.accuracy));
    progress.clear();
    let summary = summary?;
    output::deliver(&summary, &layout(&summary), arguments.json.as_deref(), &[&arguments.file])
}

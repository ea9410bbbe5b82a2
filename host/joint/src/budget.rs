//! `joint budget`: what is promised of a joint's fixed step on a board at a rate, with a verdict.

use std::path::PathBuf;

use board::target::board::Board;
use board::target::image;
use joint_file::{named, warned};
use report::failure::{Failure, Outcome};
use report::output;
use simulation::budget::{layout, refuse, summary};

/// Arguments of `joint budget`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint budget                                          joint q1 on the olimex-h405 at 20 kHz
  joint budget joints/l1.toml --board nucleo-h743zi --rate 40000
  joint budget paper --rate 10000 --json -

Exit code 2 if the board has no time for that rate; the nearest rate that it has time for is named.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(default_value = "q1", value_name = "FILE")]
    file: PathBuf,
    /// Board that steps the joint: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    board: Board,
    /// Steps a second, in Hz
    #[arg(long, value_name = "HZ", default_value_t = image::DEFAULT_TICK_RATE, value_parser = clap::value_parser!(u32).range(1..))]
    rate: u32,
    /// Writes the same figures as JSON ("-" is standard output, in place of the text)
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
}

/// Prints the certificate with its verdict.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let loaded = named::load(&arguments.file)?;
    warned::tell(&loaded);
    let parameters = &loaded.file.parameters;
    refuse(parameters, &arguments.board, arguments.rate)?;
    let summary = summary(parameters, &arguments.board, arguments.rate)
        .map_err(|error| Failure::new(format!("no fixed step for {}: {error}", parameters.name)))?;
    output::deliver(&summary, &layout(&summary), arguments.json.as_deref(), &[&arguments.file])
}

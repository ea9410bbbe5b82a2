//! `joint budget`: predicted cost and error of a joint's fixed step on a board at a rate, with verdicts on time and
//! accuracy.

use std::path::PathBuf;

use board::device::board::Board;
use board::device::image;
use joint_file::{named, warnings};
use report::failure::{Failure, Outcome};
use report::output;
use report::progress::Progress;
use simulation::budget::{layout, summary};
use simulation::verdicts::DEFAULT_ACCURACY;

use crate::image::ImageRole;

/// Arguments of `joint budget`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint budget                                          joint q1 on the olimex-h405 at 20 kHz
  joint budget joints/l1.toml --board nucleo-h743zi --rate 40000
  joint budget q1 --role loop --rate 10000              the verdict that image, flash and hil apply
  joint budget paper --rate 10000 --accuracy 1e-3 --json -

Exit code 2 if the board is too slow for the rate, 1 if the error exceeds --accuracy; the message names a rate that works.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(default_value = "q1", value_name = "FILE")]
    file: PathBuf,
    /// Board that steps the joint: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    board: Board,
    /// Role of the board
    #[arg(long, value_enum, default_value = "plant")]
    role: ImageRole,
    /// Step rate in Hz
    #[arg(long, value_name = "HZ", default_value_t = image::DEFAULT_TICK_RATE, value_parser = clap::value_parser!(u32).range(1..))]
    rate: u32,
    /// Largest acceptable error: deflections, gap and link on the reversals, over the motion's standard deviation
    /// [default: 1e-2]
    #[arg(long, value_name = "E", value_parser = parse_accuracy)]
    accuracy: Option<f64>,
    /// Writes the figures as JSON ("-": to standard output, in place of the text)
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
}

/// Prints the budget; fails if the board is too slow, or if the error exceeds `--accuracy`.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let loaded = named::load(&arguments.file)?;
    warnings::print(&loaded);
    let parameters = &loaded.file.parameters;
    let (board, role, rate) = (&arguments.board, arguments.role.role(), arguments.rate);
    let wanted = arguments.accuracy.unwrap_or(DEFAULT_ACCURACY);
    let progress = Progress::new();
    progress.stage("measuring the error");
    let summary = summary(&loaded.file, board, role, rate, wanted);
    progress.clear();
    let summary = summary?;
    output::deliver(&summary, &layout(&summary), arguments.json.as_deref(), &[&arguments.file])?;
    arguments.role.rate_check(parameters, board).check(rate)?;
    let accuracy = &summary.verdicts.accuracy;
    if arguments.accuracy.is_some() && !accuracy.reached {
        let help = match accuracy.rate_that_reaches_it_Hz {
            Some(rate) => format!("use `--rate {rate}`"),
            None => "no rate reaches that accuracy: use heavier planets or more damping".to_owned(),
        };
        let message = format!("the error of {} at {rate} Hz exceeds {wanted:.1e}", parameters.name);
        return Err(Failure::check_failed(message).with_help(help));
    }
    Ok(())
}

/// Parses a relative error; rejects values outside 0 to 1.
pub fn parse_accuracy(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err("an error over the motion's standard deviation is a number between 0 and 1, such as 1e-2".to_owned()),
    }
}

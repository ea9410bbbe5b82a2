//! `joint paper` as a separate program, started by the host command through cargo.

use std::process::ExitCode;

use clap::{Args, Command, FromArgMatches};
use paper::Arguments;

fn main() -> ExitCode {
    let command =
        Arguments::augment_args(Command::new("paper").bin_name("joint paper")).about(paper::ABOUT).long_about(None);
    report::command_line::main(command, Arguments::from_arg_matches, paper::run)
}

//! `joint bench` as a separate program, started by the host command through cargo.

use std::process::ExitCode;

use benchmark::Arguments;
use clap::{Args, Command, FromArgMatches};

fn main() -> ExitCode {
    let command =
        Arguments::augment_args(Command::new("bench").bin_name("joint bench")).about(benchmark::ABOUT).long_about(None);
    report::command_line::main(command, Arguments::from_arg_matches, benchmark::run)
}

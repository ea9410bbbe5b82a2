//! `joint release` as a separate program, started by the host command through cargo.

use std::process::ExitCode;

use clap::{Args, Command, FromArgMatches};
use release::Arguments;
use report::output;

fn main() -> ExitCode {
    let command = Command::new("release").bin_name("joint release");
    let command = Arguments::augment_args(command).about(release::ABOUT).long_about(None);
    report::command_line::main(command, Arguments::from_arg_matches, |arguments| {
        output::print(&release::run(arguments)?)
    })
}

//! The host command `joint`: arguments in, calls, exit codes. What a subcommand does is done by the crates beside this one.

mod budget;
mod check;
mod cli;
mod flash;
mod hil;
mod identify;
mod image;
mod memory;
mod merge;
mod research;
mod sim;
mod sweep;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}

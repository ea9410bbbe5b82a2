//! The host command `joint`: arguments, calls, exit codes. The work is done in the other host crates.

mod board;
mod budget;
mod check;
mod cli;
mod completions;
mod export;
mod flash;
mod hil;
mod identify;
mod image;
mod library;
mod memory;
mod merge;
mod new;
mod replay;
mod research;
mod sim;
mod sweep;
mod tables;
mod twin;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}

//! The host command `joint`: arguments in, calls, exit codes. What a subcommand does is done by the crates beside this one.

mod cli;
mod hil;
mod images;
mod research;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}

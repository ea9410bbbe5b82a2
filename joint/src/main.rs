//! Entry point of the host command `joint`. Everything it does is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    joint::cli::main()
}

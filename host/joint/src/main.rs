//! The program `joint`.

use std::process::ExitCode;

fn main() -> ExitCode {
    joint::main()
}

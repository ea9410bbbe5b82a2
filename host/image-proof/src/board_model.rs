//! Images on register-level models of their boards: the package `board-model`, which has another licence than the
//! workspace and is therefore a separate program, started through cargo.

use std::process::Stdio;

use board::device::packages;
use board::device::tool;
use report::failure::{Failure, Outcome};
use report::output;
use report::progress::Progress;
use report::workspace::workspace;

/// Packages to build the emulator library of the board model.
const PACKAGES: [&str; 3] = ["cmake", "libclang-dev", "build-essential"];

/// Installs what the board model is built with.
pub fn prepare(progress: &Progress) -> Outcome<()> {
    packages::ensure(&PACKAGES, "to build the model of the boards", &|line| progress.print_message(line))?;
    progress.clear();
    Ok(())
}

/// Runs the short form of the board model's checks; it prints a line per check.
pub fn check() -> Outcome<()> {
    let status = tool::cargo()
        .args(["run", "--quiet", "--release", "--manifest-path", "board-model/Cargo.toml", "--", "check"])
        .current_dir(workspace())
        .stdin(Stdio::null())
        .status()
        .map_err(|error| Failure::new(format!("cannot run cargo for the model of the boards: {error}")))?;
    match status.success() {
        true => output::print("ok       images on the models of their boards\n"),
        false => Err(Failure::check_failed(format!("an image failed on the model of its board ({status})"))
            .with_help("board-model/README.md describes the checks and how to run one of them")),
    }
}

//! `joint paper`, `joint bench` and `joint release`: programs of their own, built on demand. They are started through cargo
//! with the rest of the command line, in the user's folder.

use std::ffi::OsString;
use std::process::Command;

use board::device::packages::{self, Install};
use board::device::tool;
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;
use report::workspace::{require_sources, workspace};

/// Arguments that are passed on to the program unchanged.
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub struct Arguments {
    /// Arguments of the program
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<OsString>,
}

/// Builds and runs a program of the workspace; ends with the program's exit code.
pub fn run(package: &str, rest: &[OsString]) -> Outcome<()> {
    require_sources(&format!("the program `{package}`"))?;
    // Ctrl-C reaches the program as well, which ends in order; this process waits for it.
    interruption::watch()?;
    let _uninterrupted = interruption::UninterruptedWork::begin();
    let progress = Progress::new();
    progress.stage(&format!("building {package}"));
    let built = tool::run_with_progress(&mut cargo("build", package), &format!("building {package}"), &|line| {
        progress.print_message(line)
    });
    progress.clear();
    interruption::explain(built)?;
    let status = cargo("run", package)
        .args(["--quiet", "--"])
        .args(rest)
        .env(packages::INSTALL_VARIABLE, Install::effective()?.word())
        .status()
        .map_err(|error| Failure::new(format!("cannot start `{package}` through cargo: {error}")))?;
    match status.code() {
        Some(0) => Ok(()),
        // The program has printed its own error.
        Some(code) => std::process::exit(code),
        None => Err(Failure::interrupted(format!("a signal ended `{package}`"))),
    }
}

/// Cargo command for a package of the workspace.
fn cargo(subcommand: &str, package: &str) -> Command {
    let mut command = tool::cargo();
    command.args([subcommand, "--package", package, "--manifest-path"]);
    command.arg(workspace().join("Cargo.toml"));
    command
}

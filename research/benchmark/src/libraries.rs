//! Host libraries, timed by a program of the workspace that is built for the purpose: they are too many dependencies for this command.
//! CVODE is included where SUNDIALS is installed or can be installed.

use std::process::Command;

use serde::{Deserialize, Serialize};

use board::device::{Say, packages, tool};
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

/// Debian's package of SUNDIALS.
const SUNDIALS: &str = "libsundials-dev";

/// Time and error of one method at one setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Time {
    /// Case.
    pub case: String,
    /// Method.
    pub name: String,
    /// Tolerance, or step h omega_n.
    pub setting: f64,
    /// Trajectory error, worst over the phases; none if the method failed.
    pub error: Option<f64>,
    /// Processor seconds for a second of the joint.
    pub cost: f64,
}

/// Times of all methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Times {
    /// Time of every method at every setting.
    pub times: Vec<Time>,
    /// Reason why CVODE is missing, if it is.
    pub without_cvode: Option<String>,
}

/// Builds the program and runs it on the named cases.
pub fn run(cases: &[String], say: Say<'_>) -> Outcome<Times> {
    let without_cvode =
        packages::ensure(&[SUNDIALS], "to time CVODE", say).err().map(|failure| failure.message().into());
    if without_cvode.is_none() {
        match time(cases, "cvode", say) {
            Ok(times) => return Ok(Times { times, without_cvode: None }),
            Err(failure) => say(&format!("CVODE skipped: {}", failure.message())),
        }
    }
    let times = time(cases, "libraries", say)?;
    let reason = without_cvode.unwrap_or_else(|| format!("the library installed by {SUNDIALS} cannot be linked"));
    Ok(Times { times, without_cvode: Some(reason) })
}

fn time(cases: &[String], feature: &str, say: Say<'_>) -> Outcome<Vec<Time>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let command = |subcommand: &str| {
        let mut command = Command::new(&cargo);
        command.current_dir(workspace()).args([
            subcommand,
            "--release",
            "--package",
            "comparison",
            "--bin",
            "library_times",
            "--features",
            feature,
        ]);
        command
    };
    tool::run_with_progress(&mut command("build"), "building the host libraries", say)?;
    say("timing the host libraries");
    let text = tool::capture_output(command("run").arg("--quiet").arg("--").args(cases))?;
    serde_json::from_str(&text).map_err(|error| Failure::new(format!("the times of the host libraries: {error}")))
}

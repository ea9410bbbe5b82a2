//! Unit tests of the core that fail under a factor: many thresholds guard against faults that no closed loop of `runs` has.

use std::collections::BTreeSet;
use std::env;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use model_core::numbers::sensitivity::{FACTORS, Threshold, VARIABLE};
use report::failure::{Failure, Outcome};
use report::interruption;
use report::workspace::workspace;
use serde_json::Value;

/// Cell of a threshold that no unit test holds.
pub const NONE: &str = "none";

/// Program with the unit tests.
pub struct UnitTests {
    program: PathBuf,
}

impl UnitTests {
    /// Builds the program. All tests must pass with the tuned thresholds.
    pub fn build() -> Outcome<Self> {
        let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(["test", "--quiet", "--no-run", "--message-format", "json-render-diagnostics"]);
        cargo.args(["--package", "model-core", "--lib", "--features", "sensitivity"]).current_dir(workspace());
        let output = cargo.stderr(Stdio::inherit()).output();
        let output = output.map_err(|error| Failure::new(format!("cannot start cargo: {error}")))?;
        let program = String::from_utf8_lossy(&output.stdout).lines().find_map(executable);
        let Some(program) = program.filter(|_| output.status.success()) else {
            return Err(Failure::new("the unit tests of model-core do not compile"));
        };
        let tests = Self { program };
        match tests.failed(None)?.first() {
            Some(name) => Err(Failure::new(format!("the unit test {name} fails with the tuned thresholds"))),
            None => Ok(tests),
        }
    }

    /// Cell of a threshold: first unit test that fails under a factor, and the number of others.
    pub fn cell(&self, threshold: &Threshold) -> Outcome<String> {
        let mut failed = BTreeSet::new();
        for (factor, value) in FACTORS.into_iter().zip(&threshold.scaled) {
            if *value != threshold.value {
                failed.extend(self.failed(Some((threshold.name, factor)))?);
            }
        }
        Ok(text(&failed))
    }

    /// Names of the unit tests that fail under a factor.
    fn failed(&self, factor: Option<(&str, f64)>) -> Outcome<BTreeSet<String>> {
        let mut program = Command::new(&self.program);
        program.env_remove(VARIABLE).env("RUST_BACKTRACE", "0").current_dir(workspace().join("model-core"));
        if let Some((name, factor)) = factor {
            program.env(VARIABLE, format!("{name}={factor}"));
        }
        let output = program.output().map_err(|error| Failure::new(format!("cannot start the unit tests: {error}")))?;
        if interruption::requested() {
            return Err(Failure::interrupted("stopped by the user"));
        }
        let failed = failures(&String::from_utf8_lossy(&output.stdout));
        // The exit codes of the test harness: 0, and 101 after failed tests.
        match (output.status.code(), failed.is_empty()) {
            (Some(0), true) | (Some(101), false) => Ok(failed),
            _ => Err(Failure::new(format!(
                "the unit tests under {} ended with {}",
                factor.map_or_else(|| "the tuned thresholds".to_owned(), |(name, factor)| format!("{factor} x {name}")),
                output.status
            ))),
        }
    }
}

/// Program named in a line of cargo's messages.
fn executable(line: &str) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    Some(message.get("executable")?.as_str()?.into())
}

/// Failed tests in the output of a test program, without the module `tests`.
fn failures(output: &str) -> BTreeSet<String> {
    let name = |line: &str| {
        Some(line.strip_prefix("test ")?.strip_suffix(" ... FAILED")?.trim_end_matches(" - should panic").to_owned())
    };
    output.lines().filter_map(name).map(|name| name.replace("::tests::", "::")).collect()
}

fn text(failed: &BTreeSet<String>) -> String {
    match (failed.first(), failed.len()) {
        (None, _) => NONE.to_owned(),
        (Some(name), 1) => format!("`{name}`"),
        (Some(name), count) => format!("`{name}` and {} more", count - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failed_tests_are_read() {
        let output = "running 3 tests\ntest a::tests::holds ... ok\ntest a::tests::falls ... FAILED\ntest b::stops - should panic ... FAILED\n";
        let failed = failures(output);
        assert_eq!(failed.iter().collect::<Vec<_>>(), ["a::falls", "b::stops"]);
        assert_eq!(text(&failed), "`a::falls` and 1 more");
        assert_eq!(text(&BTreeSet::new()), "none");
    }

    #[test]
    fn program_is_read_from_messages() {
        let lines = ["{\"reason\":\"compiler-artifact\",\"executable\":null}", "{\"executable\":\"/a/b\"}"];
        assert_eq!(lines.map(executable), [None, Some(PathBuf::from("/a/b"))]);
    }
}

//! Cargo's answers about the workspace, read offline: what is not in its cache is not needed here.

use std::path::Path;
use std::process::Command;

/// Output of an offline command of Cargo.
///
/// # Panics
/// If Cargo cannot be run or reports an error.
pub fn output(root: &Path, arguments: &[&str]) -> String {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    let output = cargo.args(arguments).arg("--offline").current_dir(root).output().expect("cargo runs");
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "cargo {}: {}help: `cargo fetch` loads the packages that a build of a part has not needed",
        arguments.join(" "),
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// Metadata of Cargo, with further arguments.
///
/// # Panics
/// If Cargo cannot be run or reports an error.
pub fn metadata(root: &Path, arguments: &[&str]) -> serde_json::Value {
    let text = output(root, &[&["metadata", "--format-version", "1"], arguments].concat());
    serde_json::from_str(&text).expect("cargo metadata is JSON")
}

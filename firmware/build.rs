//! Turns a joint file into the tables that the image carries, and tells the linker about the board's memory. The joint
//! file is named by `JOINT_FILE` (default: `joints/q1.toml` of the workspace), the tick rate by `JOINT_TICK_RATE` in Hz
//! (default: 20000); what can be wrong with either is said as a build error.

use std::path::{Path, PathBuf};
use std::{env, fs};

const DEFAULT_TICK_RATE: u32 = 20_000;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    link();
    if let Err(message) = write_tables() {
        message.lines().for_each(|line| println!("cargo::error={line}"));
    }
}

/// Linker scripts, for a board only.
fn link() {
    if variable("CARGO_CFG_TARGET_OS") != Some("none".into()) {
        return;
    }
    let root = workspace();
    println!("cargo::rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo::rustc-link-search={}", root.display());
    for argument in ["--nmagic", "-Tlink.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
        println!("cargo::rustc-link-arg-examples={argument}");
    }
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
}

fn write_tables() -> Result<(), String> {
    println!("cargo::rerun-if-env-changed=JOINT_FILE");
    println!("cargo::rerun-if-env-changed=JOINT_TICK_RATE");
    let file = match variable("JOINT_FILE") {
        Some(file) => workspace().join(file),
        None => workspace().join("joints/q1.toml"),
    };
    println!("cargo::rerun-if-changed={}", file.display());
    let tick_rate = match variable("JOINT_TICK_RATE") {
        Some(rate) => rate.parse().map_err(|_| format!("JOINT_TICK_RATE={rate}: want a whole number of Hz"))?,
        None => DEFAULT_TICK_RATE,
    };
    let text = fs::read_to_string(&file).map_err(|error| format!("joint file {}: {error}", file.display()))?;
    let joint = joints::read(&text).map_err(|problems| {
        let list: Vec<_> = problems.iter().map(|problem| format!("{}: {problem}", file.display())).collect();
        format!("{}\nrun `cargo joint check {}` to see the places", list.join("\n"), file.display())
    })?;
    let source = model_core::design::rust_source(&joint.parameters, tick_rate)
        .map_err(|error| format!("{}: {error}", file.display()))?;
    let out = PathBuf::from(variable("OUT_DIR").ok_or("no OUT_DIR")?).join("tables.rs");
    fs::write(&out, source).map_err(|error| format!("{}: {error}", out.display()))
}

fn workspace() -> PathBuf {
    let package = variable("CARGO_MANIFEST_DIR").unwrap_or_default();
    Path::new(&package).parent().map(Path::to_path_buf).unwrap_or_default()
}

fn variable(name: &str) -> Option<String> {
    env::var(name).ok()
}

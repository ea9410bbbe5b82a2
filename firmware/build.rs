//! Turns a joint file into the tables that the image carries, and tells the linker about the board's memory. The joint
//! file is named by `JOINT_FILE` (default: `joints/q1.toml` of the workspace), the tick rate by `JOINT_TICK_RATE` in Hz
//! (default: 20000); what can be wrong with either is said as a build error. Roles that control are made for one control
//! period a tick, for the bandwidth `JOINT_BANDWIDTH` in rad/s (default: 60), without an output encoder where
//! `JOINT_MOTOR_ONLY` is 1, and from the joint file `JOINT_TOLD` if a controller is to be told another joint than the true
//! one. Measuring binaries carry the joints that
//! `MEASURED_JOINTS` lists, in the manner of a search path, one module of tables for each.

use std::path::{Path, PathBuf};
use std::{env, fs};

use model_core::controller::design::{ControlRequest, NominalPlant, control_source};
use model_core::gears::design::Processor;

const DEFAULT_TICK_RATE: u32 = 20_000;
const DEFAULT_BANDWIDTH: f64 = 60.0;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    link();
    if let Err(message) = write_tables().and_then(|()| write_measured()) {
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
    write("tables.rs", &source(&file, tick_rate()?)?)?;
    println!("cargo::rerun-if-env-changed=JOINT_TOLD");
    let told = variable("JOINT_TOLD").map_or(file.clone(), |told| workspace().join(told));
    println!("cargo::rerun-if-changed={}", told.display());
    write("control.rs", &control(&file, &told)?)
}

/// Tables of the roles that control. A joint that cannot be controlled can still be simulated: only their binaries fail.
fn control(file: &Path, told: &Path) -> Result<String, String> {
    println!("cargo::rerun-if-env-changed=JOINT_BANDWIDTH");
    println!("cargo::rerun-if-env-changed=JOINT_MOTOR_ONLY");
    let bandwidth = match variable("JOINT_BANDWIDTH") {
        Some(typed) => typed.parse().map_err(|_| format!("JOINT_BANDWIDTH={typed}: want a number of rad/s"))?,
        None => DEFAULT_BANDWIDTH,
    };
    let tick_rate = tick_rate()?;
    let request = ControlRequest { bandwidth, output_encoder: variable("JOINT_MOTOR_ONLY") != Some("1".into()) };
    let (mut joint, mut nominal_joint) = (read(file)?, read(told)?);
    [&mut joint, &mut nominal_joint].into_iter().for_each(|joint| joint.surroundings.control_rate = tick_rate);
    let nominal = NominalPlant { joint: &nominal_joint.parameters, surroundings: &nominal_joint.surroundings, request };
    match control_source(&joint.parameters, &joint.surroundings, &nominal, &processor()?) {
        Ok(source) => Ok(source.text),
        Err(error) => Ok(format!("compile_error!({:?});\n", format!("{}: {error}", told.display()))),
    }
}

/// Modules `joint_0`, `joint_1`, ... and `visit`, which shows their tables in this order.
fn write_measured() -> Result<(), String> {
    if variable("CARGO_FEATURE_MEASURING").is_none() {
        return Ok(());
    }
    println!("cargo::rerun-if-env-changed=MEASURED_JOINTS");
    // The compiler must not fold the numbers into the code, which it cannot do in the image of a board either.
    let (mut modules, mut visits) = (String::from("use core::hint::black_box;\n"), String::new());
    let files = env::var_os("MEASURED_JOINTS").unwrap_or_default();
    for (index, file) in env::split_paths(&files).filter(|file| !file.as_os_str().is_empty()).enumerate() {
        println!("cargo::rerun-if-changed={}", file.display());
        let source = source(&file, tick_rate()?)?;
        modules += &format!("mod joint_{index} {{\n{source}}}\n");
        visits += &format!("    visitor.joint(joint_{index}::JOINT_NAME, black_box(&joint_{index}::TABLES));\n");
    }
    let visitor = if visits.is_empty() { "_" } else { "visitor" };
    let visit = format!("pub fn visit({visitor}: &mut impl super::Visitor) {{\n{visits}}}\n");
    write("measured.rs", &(modules + &visit))
}

/// The tables of a joint file, as a module's text.
fn source(file: &Path, tick_rate: u32) -> Result<String, String> {
    let joint = read(file)?;
    model_core::gears::design::rust_source_for(&joint.parameters, tick_rate, &processor()?)
        .map_err(|error| format!("{}: {error}", file.display()))
}

fn read(file: &Path) -> Result<joint_file::JointFile, String> {
    let text = fs::read_to_string(file).map_err(|error| format!("joint file {}: {error}", file.display()))?;
    joint_file::read(&text).map_err(|problems| {
        let list: Vec<_> = problems.iter().map(|problem| format!("{}: {problem}", file.display())).collect();
        format!("{}\nrun `cargo joint check {}` to see the places", list.join("\n"), file.display())
    })
}

/// What the board of this build has time for.
fn processor() -> Result<Processor, String> {
    let boards = ["stm32f405", "stm32g474", "stm32h743"];
    let chosen = |board: &&str| variable(&format!("CARGO_FEATURE_{}", board.to_uppercase())).is_some();
    let board = boards.into_iter().find(chosen).ok_or_else(|| format!("no board: want a feature of {boards:?}"))?;
    Processor::of_board(board).ok_or_else(|| format!("{board} is not known to the design"))
}

fn tick_rate() -> Result<u32, String> {
    match variable("JOINT_TICK_RATE") {
        Some(rate) => rate.parse().map_err(|_| format!("JOINT_TICK_RATE={rate}: want a whole number of Hz")),
        None => Ok(DEFAULT_TICK_RATE),
    }
}

fn write(name: &str, source: &str) -> Result<(), String> {
    let out = PathBuf::from(variable("OUT_DIR").ok_or("no OUT_DIR")?).join(name);
    fs::write(&out, source).map_err(|error| format!("{}: {error}", out.display()))
}

fn workspace() -> PathBuf {
    let package = variable("CARGO_MANIFEST_DIR").unwrap_or_default();
    Path::new(&package).parent().map(Path::to_path_buf).unwrap_or_default()
}

fn variable(name: &str) -> Option<String> {
    env::var(name).ok()
}

//! Generates the image's constants and memory layout from a board file, and its tables from a joint file. Inputs:
//! `BOARD_FILE` (default: the preset of the selected chip), `JOINT_FILE` (default: `joints/q1.toml` of the workspace),
//! tick rate `JOINT_TICK_RATE` in Hz (default: 20000); errors in either file become build errors. Roles that control
//! are designed for one control period per tick, for the bandwidth `JOINT_BANDWIDTH` in rad/s (default: 60, or the
//! limit of the joint), for the largest torque through the teeth `JOINT_PEAK_TORQUE` in N m (default: the limit of the
//! joint), without an output encoder if `JOINT_MOTOR_ONLY` is 1, and from the joint file `JOINT_TOLD` if the
//! controller's joint is to differ from the true one. Role `drive` has the drive `JOINT_DRIVE`, such as `odrive3`, with
//! the identifier `JOINT_DRIVE_ID` (default: 1). `JOINT_FORCED` is 1 if the worst-case tick exceeds the available
//! time and the build was forced; the hello reports it. Measuring binaries contain one module of tables for each joint
//! of `MEASURED_JOINTS`, a list in the form of a search path.

use std::path::{Path, PathBuf};
use std::{env, fs};

use board_file::{Board, Chip};
use model_core::controller::design::{ControlRequest, NominalPlant, control_source};
use virtual_drive::maker::{NAMES, Name};

const DEFAULT_TICK_RATE: u32 = 20_000;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Err(message) = board().and_then(|board| {
        link(&board)?;
        write_tables(board.chip)?;
        write_drive(&board)?;
        write_measured(board.chip)
    }) {
        message.lines().for_each(|line| println!("cargo::error={line}"));
    }
}

/// Reads the board of this build and writes its constants.
fn board() -> Result<Board, String> {
    println!("cargo::rerun-if-env-changed=BOARD_FILE");
    let chip = chip()?;
    let file = match variable("BOARD_FILE") {
        Some(file) => workspace().join(file),
        None => {
            let preset = board_file::boards_with(chip).first().copied().ok_or("no board file has this chip")?;
            workspace().join("boards").join(preset).with_added_extension("toml")
        }
    };
    println!("cargo::rerun-if-changed={}", file.display());
    let text = fs::read_to_string(&file).map_err(|error| format!("board file {}: {error}", file.display()))?;
    let board = board_file::read(&text).map_err(|problems| {
        let list: Vec<_> = problems.iter().map(|problem| format!("{}: {problem}", file.display())).collect();
        format!("{}\nrun `cargo joint board check {}` to see the places", list.join("\n"), file.display())
    })?;
    if board.chip != chip {
        let (name, its) = (chip.name(), board.chip.name());
        return Err(format!("{}: the board's chip is {its}, and the build is for {name}", file.display()));
    }
    write("board.rs", &board_file::rust_source(&board))?;
    for (name, values) in board_file::all_cfgs() {
        let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        println!("cargo::rustc-check-cfg=cfg({name}, values({}))", values.join(", "));
    }
    println!("cargo::rustc-check-cfg=cfg(has_spi_slave)");
    println!("cargo::rustc-check-cfg=cfg(has_can)");
    for (name, value) in board_file::cfgs(&board) {
        println!("cargo::rustc-cfg={name}={value:?}");
    }
    if board.spi_slave.is_some() {
        println!("cargo::rustc-cfg=has_spi_slave");
    }
    if board.can_line().is_ok() {
        println!("cargo::rustc-cfg=has_can");
    }
    Ok(board)
}

/// Selects the linker scripts, for a board only: first `board.x` with the board's memory, then the script of the
/// start-up code, which includes the workspace's `memory.x`.
fn link(board: &Board) -> Result<(), String> {
    if variable("CARGO_CFG_TARGET_OS") != Some("none".into()) {
        return Ok(());
    }
    let root = workspace();
    println!("cargo::rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo::rustc-link-search={}", root.display());
    write("board.x", &board_file::linker_script(board))?;
    let own = PathBuf::from(variable("OUT_DIR").ok_or("no OUT_DIR")?).join("board.x");
    for argument in ["--nmagic".to_owned(), format!("-T{}", own.display()), "-Tlink.x".to_owned()] {
        println!("cargo::rustc-link-arg-bins={argument}");
        println!("cargo::rustc-link-arg-examples={argument}");
    }
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    Ok(())
}

fn write_tables(chip: Chip) -> Result<(), String> {
    println!("cargo::rerun-if-env-changed=JOINT_FILE");
    println!("cargo::rerun-if-env-changed=JOINT_TICK_RATE");
    let file = match variable("JOINT_FILE") {
        Some(file) => workspace().join(file),
        None => workspace().join("joints/q1.toml"),
    };
    println!("cargo::rerun-if-changed={}", file.display());
    println!("cargo::rerun-if-env-changed=JOINT_FORCED");
    let forced = variable("JOINT_FORCED") == Some("1".into());
    let forced = format!(
        "/// The worst tick outlasts what the role may take of a period, and the image was built all the same.\n\
         pub const FORCED: bool = {forced};\n"
    );
    write("tables.rs", &(source(&file, tick_rate()?, chip)? + &forced))?;
    println!("cargo::rerun-if-env-changed=JOINT_TOLD");
    let told = variable("JOINT_TOLD").map_or(file.clone(), |told| workspace().join(told));
    println!("cargo::rerun-if-changed={}", told.display());
    write("control.rs", &control(&file, &told, chip)?)
}

/// Writes the tables of the roles that control. A joint that cannot be controlled can still be simulated: only the
/// binaries of these roles fail.
fn control(file: &Path, told: &Path, chip: Chip) -> Result<String, String> {
    println!("cargo::rerun-if-env-changed=JOINT_MOTOR_ONLY");
    let tick_rate = tick_rate()?;
    let request = ControlRequest {
        bandwidth: number("JOINT_BANDWIDTH", "rad/s")?,
        peak_torque: number("JOINT_PEAK_TORQUE", "N m")?,
        output_encoder: variable("JOINT_MOTOR_ONLY") != Some("1".into()),
    };
    let (mut joint, mut nominal_joint) = (read(file)?, read(told)?);
    [&mut joint, &mut nominal_joint].into_iter().for_each(|joint| joint.surroundings.control_rate = tick_rate);
    let nominal = NominalPlant { joint: &nominal_joint.parameters, surroundings: &nominal_joint.surroundings, request };
    match control_source(&joint.parameters, &joint.surroundings, &nominal, &chip.processor()) {
        Ok(source) => Ok(source.text),
        Err(error) => Ok(format!("compile_error!({:?});\n", format!("{}: {error}", told.display()))),
    }
}

/// Writes maker, identifier and numbers of the drive of role `drive`.
fn write_drive(board: &Board) -> Result<(), String> {
    println!("cargo::rerun-if-env-changed=JOINT_DRIVE");
    println!("cargo::rerun-if-env-changed=JOINT_DRIVE_ID");
    let Some(maker) = variable("JOINT_DRIVE").filter(|typed| !typed.is_empty()) else {
        return write("drive.rs", "compile_error!(\"JOINT_DRIVE names no drive\");\n");
    };
    let maker = Name::from_word(&maker)
        .ok_or_else(|| format!("JOINT_DRIVE={maker}: want one of {:?}", NAMES.map(|name| name.word)))?;
    let can =
        board.can_line().map_err(|why| format!("JOINT_DRIVE={}: {} is no drive: {why}", maker.word, board.name))?;
    if maker.is_flexible && can.data_bitrate.is_none() {
        let why = "its frames are CAN FD, and the board file has no `data_bitrate` in [can]";
        return Err(format!("JOINT_DRIVE={}: {why}", maker.word));
    }
    let id = number("JOINT_DRIVE_ID", "the bus")?.unwrap_or(1.0);
    if !(1.0..=f64::from(maker.max_id)).contains(&id) || id.fract() != 0.0 {
        return Err(format!("JOINT_DRIVE_ID={id}: want a whole number from 1 to {}", maker.max_id));
    }
    let file = variable("JOINT_FILE").map_or_else(|| workspace().join("joints/q1.toml"), |file| workspace().join(file));
    let mut joint = read(&file)?;
    joint.surroundings.control_rate = tick_rate()?;
    let bandwidth = model_core::compensation::design::good_bandwidth(&joint.parameters, &joint.surroundings)
        .map_err(|error| format!("{}: {error}", file.display()))?;
    let design = virtual_drive::DriveDesign::new(&joint.parameters, &joint.surroundings, bandwidth, true);
    let source = format!(
        "/// Maker of the drive.\npub type ThisMaker = virtual_drive::maker::{};\n\
         /// Identifier of the drive on the bus.\npub const ID: u8 = {id};\n\
         /// Numbers of the drive.\npub const DESIGN: virtual_drive::DriveDesign = {};\n",
        maker.type_name,
        design.rust_source()
    );
    write("drive.rs", &source)
}

/// Writes modules `joint_0`, `joint_1`, ... and `visit`, which visits their tables in this order.
fn write_measured(chip: Chip) -> Result<(), String> {
    if variable("CARGO_FEATURE_MEASURING").is_none() {
        return Ok(());
    }
    println!("cargo::rerun-if-env-changed=MEASURED_JOINTS");
    // The compiler must not fold the numbers into the code, as it cannot in a board's image.
    let (mut modules, mut visits) = (String::from("use core::hint::black_box;\n"), String::new());
    let files = env::var_os("MEASURED_JOINTS").unwrap_or_default();
    for (index, file) in env::split_paths(&files).filter(|file| !file.as_os_str().is_empty()).enumerate() {
        println!("cargo::rerun-if-changed={}", file.display());
        let source = source(&file, tick_rate()?, chip)?;
        modules += &format!("mod joint_{index} {{\n{source}}}\n");
        visits += &format!("    visitor.joint(joint_{index}::JOINT_NAME, black_box(&joint_{index}::TABLES));\n");
    }
    let visitor = if visits.is_empty() { "_" } else { "visitor" };
    let visit = format!("pub fn visit({visitor}: &mut impl super::Visitor) {{\n{visits}}}\n");
    write("measured.rs", &(modules + &visit))
}

/// Returns the tables of a joint file as the text of a module.
fn source(file: &Path, tick_rate: u32, chip: Chip) -> Result<String, String> {
    let joint = read(file)?;
    model_core::gears::design::rust_source_for(&joint.parameters, tick_rate, &chip.processor())
        .map_err(|error| format!("{}: {error}", file.display()))
}

fn read(file: &Path) -> Result<joint_file::JointFile, String> {
    let text = fs::read_to_string(file).map_err(|error| format!("joint file {}: {error}", file.display()))?;
    joint_file::read(&text).map_err(|problems| {
        let list: Vec<_> = problems.iter().map(|problem| format!("{}: {problem}", file.display())).collect();
        format!("{}\nrun `cargo joint check {}` to see the places", list.join("\n"), file.display())
    })
}

/// Returns the chip of this build.
fn chip() -> Result<Chip, String> {
    let chosen = |chip: &Chip| variable(&format!("CARGO_FEATURE_{}", chip.name().to_uppercase())).is_some();
    let names = Chip::ALL.map(Chip::name);
    let mut all = Chip::ALL.into_iter().filter(chosen);
    let first = all.next();
    if all.next().is_some() {
        return Err("one chip at a time: build with --no-default-features --features <chip>".to_owned());
    }
    first.ok_or_else(|| format!("no chip: want a feature of {names:?}; {}", board_file::OTHER_CHIPS))
}

/// Reads a number from the environment; `None` if the variable is absent or empty.
fn number(name: &str, unit: &str) -> Result<Option<f64>, String> {
    println!("cargo::rerun-if-env-changed={name}");
    let Some(typed) = variable(name).filter(|typed| !typed.is_empty()) else { return Ok(None) };
    typed.parse().map(Some).map_err(|_| format!("{name}={typed}: want a number of {unit}"))
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

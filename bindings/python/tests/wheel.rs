//! The Python wheel, built as for a release, installed on a machine without Rust and driven by Python: the module, the
//! command, the notebook, and the bits of the core.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use board::device::board::Board;
use c_library::tables::{make, nominal};
use joint_file::named;
use model_core::compensation::{Command as SetPoint, Compensation, Motion, Position};
use model_core::controller::design::ControlRequest;
use model_core::gears::Tables;
use model_core::numbers::digest::{START, chain};
use model_core::observer::{MAPPED, Observer};
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};
use release::parts::{Builds, build_folder, wheel};
use release::source::Source;
use report::workspace::workspace;

/// Packages of the tests, with pytest and what runs a notebook.
const PACKAGES: [&str; 8] = [
    "numpy==2.4.6",
    "pytest==9.2.0",
    "pandas==3.1.1",
    "matplotlib==3.11.2",
    "nbclient==0.11.0",
    "ipykernel==7.4.0",
    "mypy==2.4.1",
    "gymnasium==1.4.0",
];
/// Version of the tool that names the oldest C library of the wheel.
const AUDITWHEEL: &str = "auditwheel==6.8.2";
/// Joints whose bits are compared: gears with planets, and an equivalent gear.
const JOINTS: [&str; 4] = ["q1", "s1", "l1", "c1"];
/// Periods of the comparison.
const PERIODS: u32 = 20_000;
/// Periods of a motion to and fro.
const MOTION_PERIODS: u32 = 2000;
/// Longest time to install the wheel and the packages that it depends on [s].
const INSTALL_MAX: u64 = 60;

fn bindings() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

fn succeeded(command: &mut Command) -> String {
    let ended = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let printed = String::from_utf8_lossy(&[ended.stdout, ended.stderr].concat()).into_owned();
    assert!(ended.status.success(), "{command:?}:\n{printed}");
    printed
}

/// Python environment in a new folder, with packages.
fn environment(place: &Path, packages: &[&str]) -> PathBuf {
    succeeded(Command::new("python3").args(["-m", "venv", "--clear"]).arg(place));
    let python = place.join("bin/python");
    if !packages.is_empty() {
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        succeeded(Command::new(&python).args(pip).args(packages));
    }
    python
}

/// Torque command and load of a period [N m].
fn torques(period: u32) -> (f32, f32) {
    let sign = |half: u32| if (period / half).is_multiple_of(2) { 1.0 } else { -1.0 };
    (0.25 * sign(700), sign(1100))
}

/// Set-point of a period: a motion to and fro, with the operations in the order of the Python half.
fn motion(period: u32) -> Motion<f32> {
    let phase = f64::from(period % MOTION_PERIODS) / f64::from(MOTION_PERIODS);
    let rest = 1.0 - phase;
    let position = 0.48 * phase * phase * rest * rest;
    let turns = (position / TAU).round();
    Motion {
        position: Position { turns: turns as i32, fraction: (position / TAU - turns) as f32 },
        speed: (4.8 * phase * rest * (rest - phase)) as f32,
        acceleration: (24.0 * (rest * rest - 4.0 * phase * rest + phase * phase)) as f32,
    }
}

/// Digest of a plant under the torques, and torques of the compensation that follows a motion under the loads.
fn bits<const N: usize>(
    gears: &Tables<f32, N>,
    around: &SurroundingsTable<f32>,
    blob: &table_blob::Blob<'_>,
) -> (u64, u64) {
    let mut plant = VirtualJoint::new(gears, around);
    for period in 0..PERIODS {
        let (torque, load) = torques(period);
        plant.advance(torque, load);
    }
    let digest = plant.model().state_digest();
    let mut plant = VirtualJoint::new(gears, around);
    let mut observer = Observer::<f32, MAPPED>::new(blob.observer().expect("a part"));
    let mut compensation = Compensation::new(blob.compensation().expect("a part"));
    let mut running = START;
    let header = blob.header();
    let lead = (blob.compensation().expect("a part").crossing.lead * header.control_rate as f32).round() as u32;
    for period in 0..PERIODS {
        let ahead = (period + lead < PERIODS).then(|| motion(period + lead));
        let command = SetPoint::Position { now: motion(period), ahead };
        let done = compensation.step(observer.step(&plant.samples()), &command);
        plant.advance(done.torque, torques(period).1);
        running = chain(running, done.torque.to_bits().into());
    }
    (digest, running)
}

/// Expected bits of the joints as JSON.
fn expected_bits() -> String {
    let lines = JOINTS.map(|name| {
        let joint = named::load(Path::new(name)).expect("a preset").file;
        let tables = make(&joint, &nominal(&joint, ControlRequest::USUAL), true, &Board::emulated()).expect("tables");
        let blob = table_blob::Blob::open(&tables.words).expect("tables");
        let (gears, around) = blob.plant().expect("a plant");
        let (plant, controller) = match gears {
            table_blob::Gears::One(gears) => bits(gears, around, &blob),
            table_blob::Gears::Three(gears) => bits(gears, around, &blob),
            table_blob::Gears::Four(gears) => bits(gears, around, &blob),
            table_blob::Gears::Five(gears) => bits(gears, around, &blob),
        };
        let tables = tables.digest();
        format!("\"{name}\": {{\"plant\": {plant}, \"controller\": {controller}, \"tables\": {tables}}}")
    });
    format!("{{\"periods\": {PERIODS}, \"joints\": {{{}}}}}", lines.join(", "))
}

/// Search path of the user: a folder that does not exist, so that neither cargo nor a compiler is found.
const PATH_WITHOUT_RUST: &str = "/none";

/// The wheel installs within a minute and does in a folder without sources what its tests say.
#[test]
#[ignore = "builds and installs the wheel: cargo test -p python-bindings -- --ignored --nocapture"]
fn wheel_passes_its_tests_without_rust() {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wheel");
    fs::create_dir_all(&place).expect("the build directory is writable");
    let bits = place.join("bits.json");
    fs::write(&bits, expected_bits()).expect("a file");
    let tools = environment(&place.join("tools"), &[AUDITWHEEL]);
    let begin = Instant::now();
    let source = Source::of_commit(&workspace()).expect("a clone");
    let say = |line: &str| println!("{line}");
    let file = wheel(&Builds { source: &source, folder: &build_folder(), say: &say }).expect("a wheel");
    println!("build: {:.0} s", begin.elapsed().as_secs_f64());
    let (name, size) = (file.path, file.bytes.len());
    println!("{name}: {size} B");
    let wheel = place.join(&name);
    fs::write(&wheel, file.bytes).expect("a file");
    assert!(name.contains("-cp310-abi3-") && name.contains("manylinux_2_17"), "{name}");
    println!("{}", succeeded(Command::new(&tools).args(["-m", "auditwheel", "show"]).arg(&wheel)));

    let python = environment(&place.join("user"), &[]);
    let begin = Instant::now();
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    succeeded(Command::new(&python).args(install).arg(&wheel).env("PATH", PATH_WITHOUT_RUST));
    println!("install: {:.1} s", begin.elapsed().as_secs_f64());
    assert!(begin.elapsed().as_secs() < INSTALL_MAX);
    succeeded(Command::new(&python).args(install).args(PACKAGES));

    let folder = tempfile::tempdir().expect("a folder");
    let tests = folder.path().join("tests");
    for kind in ["tests", "notebooks", "examples"] {
        let copy = folder.path().join(kind);
        succeeded(Command::new("cp").arg("-r").arg(bindings().join(kind)).arg(copy));
    }
    let run = Command::new(&python)
        .args(["-m", "pytest", "-q", "-s", "--durations=5", "-p", "no:cacheprovider"])
        .arg(&tests)
        .current_dir(folder.path())
        .env("PATH", PATH_WITHOUT_RUST)
        .env("LOSTMOTION_BITS", &bits)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .expect("an interpreter");
    let printed = String::from_utf8_lossy(&[run.stdout, run.stderr].concat()).into_owned();
    println!("{printed}");
    assert!(run.status.success(), "{printed}");
}

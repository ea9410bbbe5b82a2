//! Tasks on a Dask cluster whose workers are killed, and in a SLURM array on one node, against one process: equal bytes.
//! `cluster.py` has the runs; this file makes their environment from the library of this build, without a wheel.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages of the cluster.
const PACKAGES: [&str; 2] = ["numpy==2.4.6", "distributed==2026.8.0"];

fn succeeded(command: &mut Command) {
    let status = command.status().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(status.success(), "{command:?}: {status}");
}

/// Python with the packages and the module of this build.
fn python() -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cluster");
    let python = place.join("bin/python");
    if !place.join("ready").exists() {
        succeeded(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&place));
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        succeeded(Command::new(&python).args(pip).args(PACKAGES));
        fs::write(place.join("ready"), "").expect("room");
    }
    let packages = fs::read_dir(place.join("lib")).expect("a folder").next().expect("a Python").expect("a folder");
    let module = packages.path().join("site-packages/lostmotion");
    let _ = fs::remove_dir_all(&module);
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/lostmotion");
    succeeded(Command::new("cp").arg("-rL").arg(sources).arg(&module));
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--package", "python-bindings"]);
    succeeded(if cfg!(debug_assertions) { &mut build } else { build.arg("--release") });
    // A test's program lies in the folder `deps` below the library.
    let program = std::env::current_exe().expect("a program");
    let library = program.ancestors().nth(2).expect("a folder").join("liblostmotion.so");
    fs::copy(&library, module.join("_native.abi3.so")).unwrap_or_else(|error| panic!("{}: {error}", library.display()));
    python
}

fn run(engine: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cluster.py");
    succeeded(Command::new(python()).arg(script).arg(engine).arg(folder.path()).env("PYTHONDONTWRITEBYTECODE", "1"));
}

#[test]
#[ignore = "a cluster on this machine, 10,000 joints: cargo test -p python-bindings --test cluster -- --ignored --nocapture"]
fn clusters_give_bytes_of_one_process() {
    run("dask");
    run("slurm");
}

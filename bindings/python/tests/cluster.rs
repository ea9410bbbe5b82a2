//! Tasks on a Dask cluster whose workers are killed, and in a SLURM array on one node, against one process: equal bytes.
//! `cluster.py` has the runs; this file makes their environment from the library of this build, without a wheel.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use host_tests::packages::{self, succeeded};

/// Python with the packages of `cluster.txt` and the module of this build.
fn python() -> PathBuf {
    let all = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let python = packages::python(all, &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests"), "cluster");
    let inside = fs::read_dir(all.join("cluster/lib")).expect("a folder").next().expect("a Python").expect("a folder");
    let module = inside.path().join("site-packages/lostmotion");
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
    let mut command = Command::new(python());
    command.arg(script).arg(engine).arg(folder.path()).env("PYTHONDONTWRITEBYTECODE", "1");
    // Its figures appear while it runs.
    let status = command.status().expect("a Python");
    assert!(status.success(), "{engine}: {status}");
}

#[test]
#[ignore = "a cluster on this machine, 10,000 joints: cargo test -p python-bindings --test cluster -- --ignored --nocapture"]
fn clusters_give_bytes_of_one_process() {
    run("dask");
    run("slurm");
}

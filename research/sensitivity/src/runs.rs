//! The set of closed loops: test files of `hil` around the reference plant, run in a child process.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use model_core::numbers::digest;
use model_core::numbers::sensitivity::VARIABLE;
use report::failure::{EXIT_INTERRUPTED, Failure, Outcome};
use report::interruption;
use report::progress::Progress;
use report::seeds::Seeds;
use report::workspace::workspace;
use scenario::plant::PlantName;
use scenario::record::{TestRecord, TestsRecord};
use scenario::suite::Choice;
use scenario::{TestGroup, TestRequest};

/// Test files: motions with and without preview, both control modes, both encoders with faults, joints with real effects,
/// a joint without an output encoder, and the width probe. With one seed each, all take less than 20 s of one core.
pub const FILES: [&str; 9] = [
    "never-worse",
    "real-any",
    "t2b",
    "disturbed-hold",
    "impedance",
    "motor-faults",
    "encoder-frozen",
    "motor-only",
    "probe",
];

/// Results of the files, in their order; `None` for a file that could not run, as if the design refused the joint.
pub type Figures = Vec<Option<TestRecord>>;

/// Runs the files into a folder, in the child process. A failed bound or a refused file is a result, not an error.
pub fn run_all(folder: &Path, seeds: u64) -> Outcome<()> {
    Progress::during(|progress| {
        for name in FILES {
            let group = TestGroup {
                path: workspace().join(format!("hil/{name}.toml")),
                choice: Choice::Full,
                plant: PlantName::Reference,
                boards: None,
            };
            let request = TestRequest {
                groups: vec![group],
                seed: Some(Seeds { first: 1, last: seeds }),
                full: false,
                save_memories: false,
                name: name.to_owned(),
                out: Some(folder.join(name)),
                json: None,
                junit: None,
                live: Default::default(),
                tasks: None,
            };
            match scenario::run(&request, progress) {
                Err(failure) if failure.exit_code() == EXIT_INTERRUPTED => return Err(failure),
                _ => {}
            }
        }
        Ok(())
    })
}

/// Figures of all files with a factor on one threshold.
pub fn measure(factor: Option<(&str, f64)>, seeds: u64) -> Outcome<Figures> {
    let folder = workspace().join("target/sensitivity");
    for name in FILES {
        // A record of an earlier run would be mistaken for this run's.
        let _ = fs::remove_file(record(&folder, name));
    }
    let program = env::current_exe().map_err(|error| Failure::new(format!("cannot find this program: {error}")))?;
    let mut command = Command::new(program);
    command.args(["--seeds", &seeds.to_string(), "--run-into"]).arg(&folder);
    command.env_remove(VARIABLE).env("RAYON_NUM_THREADS", "1");
    if let Some((name, factor)) = factor {
        command.env(VARIABLE, format!("{name}={factor}"));
    }
    let output = command.output().map_err(|error| Failure::new(format!("cannot start the runs: {error}")))?;
    if interruption::requested() {
        return Err(Failure::interrupted("stopped by the user"));
    }
    let figures: Figures = FILES.iter().map(|name| read(&record(&folder, name))).collect();
    if factor.is_none() && figures.iter().any(Option::is_none) {
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(Failure::new(format!("the runs with the tuned thresholds failed: {errors}")));
    }
    Ok(figures)
}

/// Digest of runs: files, seeds, and every bit of the runs.
pub fn digest_of(figures: &Figures) -> String {
    let mut running = digest::START;
    let mut add =
        |text: &str| running = text.bytes().fold(running, |running, byte| digest::chain(running, byte.into()));
    for test in figures.iter().flatten() {
        add(&test.file_sha256);
        for run in &test.runs {
            add(&format!("{} {} {}", run.seed, run.controller, run.digest));
        }
    }
    format!("{running:016x}")
}

fn record(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).join("record.json")
}

fn read(path: &Path) -> Option<TestRecord> {
    let tests: TestsRecord = serde_json::from_str(&fs::read_to_string(path).ok()?).ok()?;
    tests.tests.into_iter().next()
}

//! Scripts of the tests in Python and Node.js: packages that are kept below the build directory until their list
//! changes, and runs with a limit on their time.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::command::folder;

/// Longest run of a script. The slowest takes a minute on a busy machine.
const MAX_RUN: Duration = Duration::from_secs(300);

/// Folder of a kind of packages, below the build directory.
pub fn place(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(kind)
}

/// Folder `name` of a kind with the packages of a list, as `host_tests::packages::packages`.
pub fn packages(kind: &str, name: &str, list: &Path, part: &str, install: impl FnOnce(&Path)) -> PathBuf {
    host_tests::packages::packages(&place(kind), name, list, part, install)
}

/// Runs a command that prepares packages; panics with the needs of the tests if it fails.
pub fn prepare(command: &mut Command, needs: &str) {
    let ended = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}\n{needs}"));
    assert!(ended.status.success(), "{command:?}:\n{}\n{needs}", String::from_utf8_lossy(&ended.stderr));
}

/// Runs a script to its end within `MAX_RUN`; returns true for success, and what it printed.
pub fn output(script: &mut Command) -> (bool, String) {
    let place = folder();
    let output = File::create(place.path().join("output")).expect("a file");
    script.stdin(Stdio::null()).stdout(output.try_clone().expect("a second handle")).stderr(output);
    let mut child = script.spawn().expect("the packages have an interpreter");
    let begin = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child of ours") {
            break status;
        }
        if begin.elapsed() > MAX_RUN {
            let _ = child.kill();
        }
        thread::sleep(Duration::from_millis(10));
    };
    let printed = fs::read_to_string(place.path().join("output")).expect("text");
    assert!(begin.elapsed() < MAX_RUN, "{script:?} was ended after {MAX_RUN:?}:\n{printed}");
    (status.success(), printed)
}

/// Runs a script that must succeed; returns what it printed.
pub fn run(script: &mut Command) -> String {
    let (is_success, printed) = output(script);
    assert!(is_success, "{script:?} failed:\n{printed}");
    printed
}

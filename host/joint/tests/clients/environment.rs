//! Python environments of the clients, kept below the build directory until their pinned packages change.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::command::{folder, text};

/// Longest run of a script. The slowest takes a minute on a busy machine.
const MAX_RUN: Duration = Duration::from_secs(300);
/// Remedy for a machine on which an environment cannot be made.
const NEEDS: &str =
    "the tests of clients need Python 3.10 or later with `venv`, and pip access to the Python package index for 10 MB";

/// Python with the packages of a client.
pub struct Environment(PathBuf);

/// Folder of the scripts and of their pinned packages.
fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

impl Environment {
    /// Environment with the packages of `<client>.txt`; made anew if the file changed.
    pub fn new(client: &str) -> Self {
        let all = Path::new(env!("CARGO_TARGET_TMPDIR")).join("clients");
        fs::create_dir_all(&all).expect("the build directory is writable");
        // One environment at a time, across the threads and processes that share the folder.
        let lock = File::create(all.join("lock")).expect("the build directory is writable");
        lock.lock().expect("a lock on a file of ours");
        let pinned = scripts().join(format!("{client}.txt"));
        let wanted = fs::read(&pinned).expect("each client has a file of pinned packages");
        let (place, stamp) = (all.join(client), all.join(client).join("installed.txt"));
        let python = place.join("bin/python");
        if fs::read(&stamp).is_ok_and(|installed| installed == wanted) && python.exists() {
            return Self(python);
        }
        // Pip itself is installed once; the clients' environments have their own packages only.
        let pip = all.join("pip/bin/python");
        if !pip.exists() {
            make(&all.join("pip"), &["--clear"]);
        }
        make(&place, &["--clear", "--without-pip"]);
        let mut install = Command::new(&pip);
        install.args(["-m", "pip", "--python", text(&python), "install", "--quiet", "--disable-pip-version-check"]);
        // The file lists every package that the script imports: optional ones such as scipy stay out.
        install.args(["--no-deps", "--requirement", text(&pinned)]);
        succeeded(&mut install);
        fs::write(&stamp, wanted).expect("the build directory is writable");
        Self(python)
    }

    /// Runs a script of this folder to its end, which must be success within `MAX_RUN`; returns what it printed.
    pub fn run(&self, script: &str, arguments: &[&str]) -> String {
        let (is_success, printed) = self.output(&scripts().join(script), arguments);
        assert!(is_success, "{script} failed:\n{printed}");
        printed
    }

    /// Runs a script to its end within `MAX_RUN`; returns true for success, and what it printed.
    pub fn output(&self, script: &Path, arguments: &[&str]) -> (bool, String) {
        let place = folder();
        let output = File::create(place.path().join("output")).expect("a file");
        let mut command = Command::new(&self.0);
        command.arg(script).args(arguments).env("PYTHONDONTWRITEBYTECODE", "1").stdin(Stdio::null());
        command.stdout(output.try_clone().expect("a second handle")).stderr(output);
        let mut child = command.spawn().expect("the environment has an interpreter");
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
        assert!(begin.elapsed() < MAX_RUN, "{} was ended after {MAX_RUN:?}:\n{printed}", script.display());
        (status.success(), printed)
    }
}

fn make(place: &Path, options: &[&str]) {
    succeeded(Command::new("python3").args(["-m", "venv"]).args(options).arg(place));
}

fn succeeded(command: &mut Command) {
    let ended: Output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}\n{NEEDS}"));
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.success(), "{command:?}:\n{said}\n{NEEDS}");
}

//! Node.js with the packages of `package.json`, kept below the build directory until that file changes.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::command::text;

/// Remedy for a machine without it.
const NEEDS: &str = "the tests of the live view's clients need Node.js 20 or later, and npm access to its registry";

/// Folder with the packages and the scripts.
pub struct Node(PathBuf);

impl Node {
    /// Node with the packages; they are installed anew if the list changed.
    pub fn new() -> Self {
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live");
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("live");
        fs::create_dir_all(&place).expect("the build directory is writable");
        let lock = File::create(place.join("lock")).expect("the build directory is writable");
        lock.lock().expect("a lock on a file of ours");
        for script in ["foxglove.mjs", "page.mjs"] {
            fs::copy(scripts.join(script), place.join(script)).expect("the build directory is writable");
        }
        let wanted = fs::read(scripts.join("package.json")).expect("a list of packages");
        let stamp = place.join("installed.json");
        if fs::read(&stamp).is_ok_and(|installed| installed == wanted) {
            return Self(place);
        }
        fs::write(place.join("package.json"), &wanted).expect("the build directory is writable");
        let mut npm = Command::new("npm");
        npm.args(["install", "--no-audit", "--no-fund", "--silent"]).current_dir(&place);
        let ended = npm.output().unwrap_or_else(|error| panic!("{npm:?}: {error}\n{NEEDS}"));
        assert!(ended.status.success(), "{npm:?}:\n{}\n{NEEDS}", String::from_utf8_lossy(&ended.stderr));
        fs::write(&stamp, wanted).expect("the build directory is writable");
        Self(place)
    }

    /// Runs a script to its end, which must be success; returns what it printed.
    pub fn run(&self, script: &str, arguments: &[&str]) -> String {
        let mut node = Command::new("node");
        node.arg(text(&self.0.join(script))).args(arguments).stdin(Stdio::null());
        let ended = node.output().unwrap_or_else(|error| panic!("{node:?}: {error}\n{NEEDS}"));
        let printed = format!("{}{}", String::from_utf8_lossy(&ended.stdout), String::from_utf8_lossy(&ended.stderr));
        assert!(ended.status.success(), "{script} failed:\n{printed}");
        printed
    }
}

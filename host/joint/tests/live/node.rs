//! Node.js with the packages of `package.json`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::scripts;

/// Remedy for a machine without Node.js.
const NEEDS: &str = "the tests of the live view's clients need Node.js 20 or later, and npm access to its registry";

/// Folder with the packages and the scripts.
pub struct Node(PathBuf);

impl Node {
    /// Node with the packages; they are installed anew if the list changed.
    pub fn new() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live");
        let list = folder.join("package.json");
        let place = scripts::packages("live", "node", &list, "node_modules", |place| {
            fs::copy(&list, place.join("package.json")).expect("the build directory is writable");
            let mut npm = Command::new("npm");
            npm.args(["install", "--no-audit", "--no-fund", "--silent"]).current_dir(place);
            scripts::prepare(&mut npm, NEEDS);
        });
        // Node.js looks for packages beside a script.
        for script in ["foxglove.mjs", "page.mjs"] {
            fs::copy(folder.join(script), place.join(script)).expect("the build directory is writable");
        }
        Self(place)
    }

    /// Runs a script to its end, which must be success; returns what it printed.
    pub fn run(&self, script: &str, arguments: &[&str]) -> String {
        scripts::run(Command::new("node").arg(self.0.join(script)).args(arguments))
    }
}

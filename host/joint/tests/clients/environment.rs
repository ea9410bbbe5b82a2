//! Python environments of the clients.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::text;
use crate::scripts;

/// Remedy for a machine on which an environment cannot be made.
const NEEDS: &str =
    "the tests of clients need Python 3.10 or later with `venv`, and pip access to the Python package index for 10 MB";
/// Kind of the packages.
const KIND: &str = "clients";

/// Python with the packages of a client.
pub struct Environment(PathBuf);

/// Folder of the scripts and of their pinned packages.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

impl Environment {
    /// Environment with the packages of `<client>.txt`; made anew if the file changed.
    pub fn new(client: &str) -> Self {
        let pinned = folder().join(format!("{client}.txt"));
        let place = scripts::packages(KIND, client, &pinned, "bin/python", |place| install(place, &pinned));
        Self(place.join("bin/python"))
    }

    /// Runs a script of this folder to its end, which must be success; returns what it printed.
    pub fn run(&self, script: &str, arguments: &[&str]) -> String {
        scripts::run(&mut self.command(&folder().join(script), arguments))
    }

    /// Runs a script to its end; returns true for success, and what it printed.
    pub fn output(&self, script: &Path, arguments: &[&str]) -> (bool, String) {
        scripts::output(&mut self.command(script, arguments))
    }

    fn command(&self, script: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.0);
        command.arg(script).args(arguments).env("PYTHONDONTWRITEBYTECODE", "1");
        command
    }
}

fn install(place: &Path, pinned: &Path) {
    // Pip itself is installed once; the clients' environments have their own packages only.
    let pip = scripts::place(KIND).join("pip");
    if !pip.join("bin/python").exists() {
        make(&pip, &["--clear"]);
    }
    make(place, &["--clear", "--without-pip"]);
    let mut install = Command::new(pip.join("bin/python"));
    let python = place.join("bin/python");
    install.args(["-m", "pip", "--python", text(&python), "install", "--quiet", "--disable-pip-version-check"]);
    // The file lists every package that the script imports: optional ones such as scipy stay out.
    install.args(["--no-deps", "--requirement", text(pinned)]);
    scripts::prepare(&mut install, NEEDS);
}

fn make(place: &Path, options: &[&str]) {
    scripts::prepare(Command::new("python3").args(["-m", "venv"]).args(options).arg(place), NEEDS);
}

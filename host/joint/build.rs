//! Sets `JOINT_VERSION` for `joint --version`: the version, and the commit if the sources lie in a git repository.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Sources of the command, relative to the workspace's folder.
const SOURCES: [&str; 5] = ["Cargo.lock", "host", "link/src", "model-core/src", "parameters/src"];

fn main() {
    let package = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let workspace = package.ancestors().nth(2).unwrap_or(&package);
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let version = match commit(workspace) {
        Some(commit) => format!("{version} ({commit})"),
        None => version,
    };
    println!("cargo::rustc-env=JOINT_VERSION={version}");
    println!("cargo::rerun-if-changed=build.rs");
    for source in sources(workspace) {
        println!("cargo::rerun-if-changed={}", source.display());
    }
    // Every commit and every checkout adds a line to this log.
    if let Some(log) = git(workspace, &["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={}", workspace.join(log).display());
    }
}

/// Commit of the sources, marked "changed" if a source differs from the commit.
fn commit(workspace: &Path) -> Option<String> {
    let commit = git(workspace, &["rev-parse", "--short=12", "HEAD"])?;
    let changes = git(workspace, &[&["status", "--porcelain", "--"], &SOURCES[..]].concat())?;
    Some(if changes.is_empty() { format!("commit {commit}") } else { format!("commit {commit}, changed") })
}

/// Paths that are compiled into the command; of each crate in `host` only its `src`, not its tests.
fn sources(workspace: &Path) -> Vec<PathBuf> {
    let mut sources = Vec::new();
    for source in SOURCES.map(|source| workspace.join(source)) {
        match source.ends_with("host") {
            true => {
                let crates = std::fs::read_dir(&source).into_iter().flatten().flatten();
                sources.extend(crates.map(|one| one.path().join("src")).filter(|path| path.is_dir()));
            }
            false => sources.push(source),
        }
    }
    sources
}

fn git(workspace: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(workspace).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

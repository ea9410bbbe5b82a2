//! Folder of this workspace, from which the firmware is built. A program that was installed without the workspace's
//! sources has a folder of data in its place.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::failure::{Failure, Outcome};

/// Folder of data of an installed program.
static INSTALLED: OnceLock<PathBuf> = OnceLock::new();

/// Variable that `joint release` sets for its builds: the programs carry no folder of the machine that built them.
pub const RELEASE_VARIABLE: &str = "JOINT_RELEASE";

/// Package of this file on the machine that built the program; `None` in a release.
const PACKAGE: Option<&str> = match option_env!("JOINT_RELEASE") {
    Some(_) => None,
    None => Some(env!("CARGO_MANIFEST_DIR")),
};

/// Folder of data of a release's program, relative to the folder above the program's own.
const SHARED: &str = "share/lostmotion";

/// Declares this process an installed program without sources, with its folder of data; later calls have no effect.
pub fn set_installed(data: PathBuf) {
    let _ = INSTALLED.set(data);
}

/// Workspace that this command was built from, with the firmware's sources; the folder of data of an installed program.
pub fn workspace() -> PathBuf {
    if let Some(data) = INSTALLED.get() {
        return data.clone();
    }
    match PACKAGE.map(Path::new) {
        Some(package) => package.ancestors().nth(2).unwrap_or(package).to_path_buf(),
        None => data_beside_program(),
    }
}

/// Folder of data of a release's program. Without a path of its own, a program has no such folder.
fn data_beside_program() -> PathBuf {
    let program = std::env::current_exe().and_then(|program| program.canonicalize()).unwrap_or_default();
    program.ancestors().nth(2).unwrap_or(Path::new("")).join(SHARED)
}

/// Returns true in an installed package that has declared itself by [`set_installed`]: the program is its interpreter.
pub fn is_declared_installed() -> bool {
    INSTALLED.get().is_some()
}

/// Returns true if the program runs in the workspace that it was built from.
pub fn has_sources() -> bool {
    INSTALLED.get().is_none() && PACKAGE.is_some()
}

/// Refuses work that needs the sources, if the program was installed without them. `purpose` completes "... needs", such
/// as "a firmware image".
pub fn require_sources(purpose: &str) -> Outcome<()> {
    if has_sources() {
        return Ok(());
    }
    Err(Failure::new(format!(
        "{purpose} needs the firmware's sources and Rust, which the installed package does not contain"
    ))
    .with_help(
        "run `cargo joint` with the same arguments in a clone of the project's repository, with Rust from rustup.rs; \
             `joint hil --host`, `joint sim` and every other command that needs no image run without both",
    ))
}

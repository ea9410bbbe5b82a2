//! Folder of this workspace, from which the firmware is built. A program that was installed without the workspace's
//! sources has a folder of data in its place.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::failure::{Failure, Outcome};

/// Folder of data of an installed program.
static INSTALLED: OnceLock<PathBuf> = OnceLock::new();

/// Declares this process an installed program without sources, with its folder of data; later calls have no effect.
pub fn set_installed(data: PathBuf) {
    let _ = INSTALLED.set(data);
}

/// Workspace that this command was built from, with the firmware's sources; the folder of data of an installed program.
pub fn workspace() -> PathBuf {
    if let Some(data) = INSTALLED.get() {
        return data.clone();
    }
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap_or(package).to_path_buf()
}

/// Returns true for a program that was installed without the workspace's sources.
pub fn is_installed() -> bool {
    INSTALLED.get().is_some()
}

/// Refuses work that needs the sources, if the program was installed without them. `purpose` completes "... needs", such
/// as "a firmware image".
pub fn require_sources(purpose: &str) -> Outcome<()> {
    if !is_installed() {
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

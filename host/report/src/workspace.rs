//! Folder of this workspace, from which the firmware is built.

use std::path::{Path, PathBuf};

/// Workspace that this command was built from, with the firmware's sources.
pub fn workspace() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap_or(package).to_path_buf()
}

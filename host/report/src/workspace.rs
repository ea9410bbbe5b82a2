//! The folder of this workspace: the firmware is built from it.

use std::path::{Path, PathBuf};

/// The workspace that this command was built from: the firmware's sources are in it.
pub fn workspace() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap_or(package).to_path_buf()
}

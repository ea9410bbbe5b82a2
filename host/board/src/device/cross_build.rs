//! Parts shared by all cross builds: the target's name, a cargo command without the host's build settings, and the
//! error for a result that cannot be written.

use std::io;
use std::path::Path;
use std::process::Command;

use report::failure::Failure;

/// The target of every board.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Removes the build settings that an outer `cargo run` or the user's shell has set for the host.
pub(super) fn clear_host_settings(command: &mut Command) -> &mut Command {
    for variable in
        ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET", "CARGO_TARGET_DIR", "LD_LIBRARY_PATH"]
    {
        command.env_remove(variable);
    }
    command
}

/// Failure for a build result that cannot be written, with its remedy.
pub fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format!("cannot write {}: {error}", path.display()))
        .with_help("make room, or set CARGO_TARGET_DIR to a folder that can be written")
}

//! What every cross build shares, with either compiler: the target's name, a cargo command without the host's build
//! settings, and the error when a result cannot be written.

use std::io;
use std::path::Path;
use std::process::Command;

use report::failure::Failure;

/// The target of every board.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Frees a cargo command from what an outer `cargo run` and the user's shell have set for the host.
pub(super) fn clean(command: &mut Command) -> &mut Command {
    for variable in
        ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET", "CARGO_TARGET_DIR", "LD_LIBRARY_PATH"]
    {
        command.env_remove(variable);
    }
    command
}

/// A file of a build that cannot be written, with the help.
pub fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format!("cannot write {}: {error}", path.display()))
        .with_help("make room, or set CARGO_TARGET_DIR to a folder that can be written")
}

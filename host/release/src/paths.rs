//! Builds of this machine's programs whose bytes depend on the sources only.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use board::device::cross_build::remapped_paths;
use report::workspace::{RELEASE_VARIABLE, workspace};

use crate::source::Source;

/// Separator of flags in `CARGO_ENCODED_RUSTFLAGS`, so that a folder's name may have blanks.
const SEPARATOR: &str = "\u{1f}";

/// Prepares a command that builds in `target_directory`: no setting of the user, no folder of the machine and no time but
/// the commit's reaches the result.
pub fn reproducible<'c>(command: &'c mut Command, source: &Source, target_directory: &Path) -> &'c mut Command {
    let flags = remapped_paths(target_directory);
    let flags = flags.into_iter().reduce(|mut all: OsString, flag| {
        all.push(SEPARATOR);
        all.push(flag);
        all
    });
    for variable in ["RUSTFLAGS", "CARGO_BUILD_TARGET", "CARGO_TARGET_DIR", "LD_LIBRARY_PATH"] {
        command.env_remove(variable);
    }
    command
        .current_dir(workspace())
        .env("CARGO_ENCODED_RUSTFLAGS", flags.unwrap_or_default())
        .env("CARGO_INCREMENTAL", "0")
        .env("CARGO_PROFILE_RELEASE_STRIP", "symbols")
        .env("SOURCE_DATE_EPOCH", source.time.to_string())
        .env(RELEASE_VARIABLE, "1")
}

//! Parts shared by all cross builds: the target's name, a cargo command without the host's build settings, and the
//! error for a result that cannot be written.

use std::env;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use report::failure::Failure;
use report::workspace::workspace;

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

/// Compiler flags that replace folders of this machine by fixed names in texts of panics and in debug information: two
/// folders, or two users, get the same bytes.
pub fn remapped_paths(target_directory: &Path) -> Vec<OsString> {
    let home = env::var_os("HOME").map(|home| PathBuf::from(home).join(".cargo"));
    let cargo_home = env::var_os("CARGO_HOME").map(PathBuf::from).or(home);
    // Of several matching prefixes the last one is used: the build directory lies in the workspace.
    let folders =
        [(cargo_home, "/cargo"), (Some(workspace()), "/lostmotion"), (Some(target_directory.to_path_buf()), "/target")];
    let flag = |(folder, name): (Option<PathBuf>, &str)| {
        let mut flag = OsString::from("--remap-path-prefix=");
        flag.push(folder?);
        flag.push("=");
        flag.push(name);
        Some(flag)
    };
    folders.into_iter().filter_map(flag).collect()
}

/// Failure for a build result that cannot be written, with its remedy.
pub fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format!("cannot write {}: {error}", path.display()))
        .with_help("make room, or set CARGO_TARGET_DIR to a folder that can be written")
}

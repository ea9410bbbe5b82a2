//! Compiles the firmware's binaries, one at a time in each build folder, and moves each result into place atomically.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::Command;

use super::cross_build::{TARGET, cannot_write, clear_host_settings};
use super::toolchain::{TARGET_FLAGS, Toolchain};
use super::{Say, tool};
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

/// The cargo profile of images.
pub const PROFILE: &str = "firmware";

/// Package with the generic code of the library. Its generic functions are compiled with the library's own package, the
/// others with this one.
const CORE_PACKAGE: &str = "model-core";

/// Package of the images.
pub(super) const FIRMWARE_PACKAGE: &str = "firmware";

/// Compiles a binary of a package for the board.
pub(super) fn compile(
    toolchain: &Toolchain,
    package: &str,
    binary: &str,
    features: &str,
    environment: &[(&str, &OsStr)],
    say: Say<'_>,
) -> Outcome<Vec<u8>> {
    // The lock spans build and copy: no other build may replace the result in between.
    let _lock = lock(toolchain.folder(), say)?;
    let mut command = toolchain.cargo("build");
    command
        .args(["--package", package, "--profile", PROFILE, "--bin", binary])
        .args(["--no-default-features", "--features", features])
        .envs(environment.iter().copied());
    tool::run_with_progress(&mut command, "building the firmware", say)?;
    let built = toolchain.folder().join(TARGET).join(PROFILE).join(binary);
    fs::read(&built).map_err(|error| Failure::new(format!("{}: {error}", built.display())))
}

/// Compiles a package as a static library for the board, with flags in addition to the toolchain's. Returns the
/// archive.
pub fn compile_library(
    toolchain: &Toolchain,
    package: &str,
    features: &str,
    flags: &str,
    say: Say<'_>,
) -> Outcome<Vec<u8>> {
    let _lock = lock(toolchain.folder(), say)?;
    let mut all_flags = toolchain.target_flags();
    all_flags.push(" ");
    all_flags.push(flags);
    let mut command = toolchain.cargo("rustc");
    add_library_arguments(&mut command, package, "staticlib", features)
        .args(size_optimised(package))
        .args(size_optimised(CORE_PACKAGE));
    command.env(TARGET_FLAGS, all_flags);
    tool::run_with_progress(&mut command, "building the library", say)?;
    read_library(&toolchain.folder().join(TARGET), package, "a")
}

/// Compiles a package as a static and a shared library for this machine. The shared library carries its soname.
pub fn compile_library_for_host(
    target_directory: &Path,
    package: &str,
    features: &str,
    soname: &str,
    say: Say<'_>,
) -> Outcome<[Vec<u8>; 2]> {
    let folder = target_directory.join("c-library");
    let _lock = lock(&folder, say)?;
    let mut command = tool::cargo();
    clear_host_settings(&mut command).current_dir(workspace()).arg("rustc").arg("--target-dir").arg(&folder);
    add_library_arguments(&mut command, package, "staticlib,cdylib", features);
    command.arg("--").arg(format!("-Clink-arg=-Wl,-soname,{soname}"));
    tool::run_with_progress(&mut command, "building the library", say)?;
    Ok([read_library(&folder, package, "a")?, read_library(&folder, package, "so")?])
}

/// Adds the arguments that make a package a library for a foreign linker. Debug information is left out: it would name
/// folders of this machine.
fn add_library_arguments<'c>(command: &'c mut Command, package: &str, kinds: &str, features: &str) -> &'c mut Command {
    command
        .args(["--package", package, "--lib", "--profile", PROFILE, "--crate-type", kinds, "--features", features])
        .env("CARGO_PROFILE_FIRMWARE_DEBUG", "0")
}

/// Cargo arguments that optimise a package for size; its dependencies keep the profile's optimisation.
fn size_optimised(package: &str) -> [String; 2] {
    ["--config".to_owned(), format!("profile.{PROFILE}.package.{package}.opt-level=\"z\"")]
}

fn read_library(folder: &Path, package: &str, extension: &str) -> Outcome<Vec<u8>> {
    let name = library_name(package);
    let built = folder.join(PROFILE).join(format!("lib{name}.{extension}"));
    fs::read(&built).map_err(|error| Failure::new(format!("{}: {error}", built.display())))
}

/// Name that cargo gives the library of a package.
fn library_name(package: &str) -> String {
    package.replace('-', "_")
}

fn lock(folder: &Path, say: Say<'_>) -> Outcome<File> {
    let path = folder.join(".one-at-a-time");
    let open = || {
        fs::create_dir_all(folder)?;
        let file = File::create(&path)?;
        tool::lock(&file, &format!("another build of firmware in {}", folder.display()), say)?;
        Ok(file)
    };
    open().map_err(|error: io::Error| cannot_write(&path, &error))
}

/// Writes a file beside its place and renames it, so that the place holds the whole file or the old one.
pub(super) fn write_atomically(images: &Path, place: &Path, elf: &[u8]) -> Outcome<()> {
    let unfinished = place.with_extension(format!("unfinished-{}", std::process::id()));
    fs::create_dir_all(images)
        .and_then(|()| fs::write(&unfinished, elf))
        .and_then(|()| fs::rename(&unfinished, place))
        .map_err(|error| cannot_write(place, &error))
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// A build that waits for another names the other build's folder.
    #[test]
    fn second_build_announces_wait() {
        let folder = tempfile::tempdir().unwrap();
        let said = Mutex::new(Vec::new());
        let say = |line: &str| said.lock().unwrap().push(line.to_owned());
        let first = lock(folder.path(), &say).unwrap();
        assert!(said.lock().unwrap().is_empty());
        std::thread::scope(|scope| {
            scope.spawn(|| lock(folder.path(), &say).unwrap());
            while said.lock().unwrap().is_empty() {
                std::thread::yield_now();
            }
            drop(first);
        });
        let said = said.into_inner().unwrap();
        assert!(said.len() == 1 && said[0].starts_with("waiting for another build of firmware in"), "{said:?}");
    }

    /// The failure names the file that could not be written.
    #[test]
    fn unwritable_image_path_named() {
        let images = Path::new("/proc/none");
        let failure = write_atomically(images, &images.join("x.elf"), b"").unwrap_err();
        assert!(failure.message().contains("/proc/none/x.elf"), "{failure}");
    }
}

//! A private sysroot: `core` for the target, built with a distribution's compiler from its library source if no
//! compiled one is installed. It is built once per compiler and renamed into place when complete.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use sha2::{Digest, Sha256};

use super::cross_build::{TARGET, cannot_write, clear_host_settings};
use super::{Say, tool};
use report::failure::Outcome;

/// Flags of the library: bitcode for fat link-time optimisation, and unstable features for a library that every crate
/// may use.
const RUSTFLAGS: &str = "-Cembed-bitcode=yes -Zforce-unstable-if-unmarked -Ctarget-cpu=cortex-m4";

const MANIFEST: &str = r#"[package]
name = "sysroot"
version = "0.0.0"
edition = "2021"

[profile.release]
panic = "abort"

[workspace]
"#;

/// Returns the sysroot of this compiler below `target_directory`, built if it is missing. `version` is the compiler's
/// verbose version text.
pub fn prepare(cargo: &Path, rustc: &Path, version: &str, target_directory: &Path, say: Say<'_>) -> Outcome<PathBuf> {
    let sysroot = target_directory.join(format!("thumb-sysroot-{}", key(version)));
    if sysroot.is_dir() {
        return Ok(sysroot);
    }
    say("building the core library for the board, once");
    let name = format!("thumb-sysroot-being-built-{}", std::process::id());
    let work = target_directory.join(name);
    let result = build(cargo, rustc, &work, say).and_then(|ready| publish(&ready, &sysroot));
    let _ = fs::remove_dir_all(&work);
    result.map(|()| sysroot)
}

/// Key that changes with the compiler, the flags and the manifest.
fn key(version: &str) -> String {
    let digest = Sha256::new().chain_update(version).chain_update(RUSTFLAGS).chain_update(MANIFEST).finalize();
    digest.iter().take(6).map(|byte| format!("{byte:02x}")).collect()
}

fn build(cargo: &Path, rustc: &Path, work: &Path, say: Say<'_>) -> Outcome<PathBuf> {
    let failed = |error: io::Error| cannot_write(work, &error);
    fs::create_dir_all(work.join("src")).map_err(failed)?;
    fs::write(work.join("Cargo.toml"), MANIFEST).map_err(failed)?;
    fs::write(work.join("src/lib.rs"), "#![no_std]\n").map_err(failed)?;
    let mut command = Command::new(cargo);
    clear_host_settings(&mut command)
        .current_dir(work)
        .env("RUSTC", rustc)
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTFLAGS", RUSTFLAGS)
        .args(["build", "--release", "--target", TARGET, "--target-dir", "target"])
        .args(["-Zbuild-std=core,alloc,compiler_builtins", "-Zbuild-std-features=compiler-builtins-mem"]);
    tool::run_with_progress(&mut command, "building the core library", say)?;

    let ready = work.join("sysroot");
    let libraries = ready.join("lib/rustlib").join(TARGET).join("lib");
    fs::create_dir_all(&libraries).map_err(failed)?;
    let built = work.join("target").join(TARGET).join("release/deps");
    for entry in fs::read_dir(&built).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let Some(name) = path.file_name() else { continue };
        let is_library = path.extension().is_some_and(|extension| extension == "rlib");
        if is_library && !name.to_string_lossy().starts_with("libsysroot") {
            fs::copy(&path, libraries.join(name)).map_err(failed)?;
        }
    }
    Ok(ready)
}

/// Renames the finished sysroot into place. If another process was faster, its equal result is kept.
fn publish(ready: &Path, sysroot: &Path) -> Outcome<()> {
    match fs::rename(ready, sysroot) {
        Err(error) if !sysroot.is_dir() => Err(cannot_write(sysroot, &error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two compilers never share a sysroot.
    #[test]
    fn sysroot_key_differs_per_compiler() {
        assert_ne!(key("rustc 1.96.0"), key("rustc 1.97.0"));
        assert_eq!(key("rustc 1.96.0"), key("rustc 1.96.0"));
    }

    /// Of two processes that build the sysroot, the second keeps the first one's result.
    #[test]
    fn finished_sysroot_of_other_process_kept() {
        let folder = tempfile::tempdir().unwrap();
        let (ours, theirs) = (folder.path().join("ours"), folder.path().join("theirs"));
        for path in [&ours, &theirs] {
            fs::create_dir(path).unwrap();
            fs::write(path.join("library"), "").unwrap();
        }
        publish(&ours, &theirs).unwrap();
        assert!(theirs.join("library").exists());
    }

    /// The failure names the folder and has a help.
    #[test]
    fn unwritable_folder_named() {
        let failure =
            prepare(Path::new("cargo"), Path::new("rustc"), "", Path::new("/proc/none"), &|_| {}).unwrap_err();
        assert!(failure.message().contains("/proc/none"), "{failure}");
        assert!(failure.help().is_some());
    }
}

//! Selects the toolchain for the board: the compiler in use if it has the target, else a distribution's compiler with
//! its library source and a private sysroot. Nothing is downloaded through rustup.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use report::workspace::{require_sources, workspace};

use super::cross_build::{TARGET, clear_host_settings, remapped_paths};
use super::{Say, packages, sysroot, tool};
use report::failure::{Failure, Outcome};

/// Oldest compiler that the workspace builds with: its `rust-version`.
const OLDEST_COMPILER: (u32, u32) = (1, 95);
/// Debian's compiler, cargo, library source and linker.
const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld"];
const DISTRIBUTION_CARGO: &str = "/usr/bin/cargo";
const DISTRIBUTION_RUSTC: &str = "/usr/bin/rustc";
const LIBRARY_SOURCE: &str = "/usr/lib/rustlib/src/rust/library/core/Cargo.toml";

/// Variable in which cargo takes the compiler's flags for the target.
pub const TARGET_FLAGS: &str = "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS";

/// Compiler and folders of a cross build.
#[derive(Debug, Clone)]
pub struct Toolchain {
    cargo: PathBuf,
    rustc: Option<PathBuf>,
    sysroot: Option<PathBuf>,
    version: String,
    folder: PathBuf,
    target_directory: PathBuf,
    /// True if results name no folder of this machine.
    is_for_release: bool,
}

impl Toolchain {
    /// Finds a toolchain or makes one. Installing packages and building a sysroot are announced.
    pub fn prepare(say: Say<'_>) -> Outcome<Self> {
        require_sources("a firmware image")?;
        let target_directory = target_directory();
        match compiler_in_use(&target_directory) {
            Some(toolchain) => Ok(toolchain),
            None => distribution(target_directory, say),
        }
    }

    /// First line of the compiler's version text.
    pub fn compiler(&self) -> &str {
        self.version.lines().next().unwrap_or_default()
    }

    /// Description of all flags that change the code, apart from the profile.
    pub fn flags(&self) -> String {
        let core = if self.sysroot.is_some() { "built here" } else { "as delivered" };
        let paths = if self.is_for_release { ", paths remapped" } else { "" };
        format!("--target {TARGET}, core library {core}{paths}")
    }

    /// Folder of images and other results.
    pub fn target_directory(&self) -> &Path {
        &self.target_directory
    }

    /// Build folder of cargo. Each toolchain has its own, because cargo does not notice a change of the compiler's
    /// library.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns this toolchain with another build folder.
    pub fn in_folder(&self, folder: &Path) -> Self {
        Self { folder: folder.to_path_buf(), ..self.clone() }
    }

    /// Returns this toolchain for a release: its results name no folder of this machine, and lie below `folder`.
    pub fn for_release(&self, folder: &Path) -> Self {
        let build = folder.join(self.folder.strip_prefix(&self.target_directory).unwrap_or(Path::new("firmware")));
        Self { folder: build, target_directory: folder.to_path_buf(), is_for_release: true, ..self.clone() }
    }

    /// Returns whether the distribution's toolchain is used; clippy must then match the compiler that built the core
    /// library.
    pub fn is_distribution(&self) -> bool {
        self.sysroot.is_some()
    }

    /// Compiler flags for the target, the value of [`TARGET_FLAGS`].
    pub fn target_flags(&self) -> OsString {
        let mut flags = OsString::new();
        if let Some(sysroot) = &self.sysroot {
            flags.push("--sysroot=");
            flags.push(sysroot);
            flags.push(" -Clinker=ld.lld -Clinker-flavor=ld.lld");
        }
        let remapped = if self.is_for_release { remapped_paths(&self.target_directory) } else { Vec::new() };
        for flag in remapped {
            flags.push(" ");
            flags.push(flag);
        }
        flags
    }

    /// Cargo command in the workspace for this toolchain, with the subcommand first.
    pub fn cargo(&self, subcommand: &str) -> Command {
        let mut command = Command::new(&self.cargo);
        clear_host_settings(&mut command).current_dir(workspace());
        if let Some(rustc) = &self.rustc {
            // Cargo looks for its plugins, such as clippy, on the search path: the distribution's must come first.
            let path = env::var_os("PATH").unwrap_or_default();
            let folders = [PathBuf::from("/usr/bin")].into_iter().chain(env::split_paths(&path));
            if let Ok(path) = env::join_paths(folders) {
                command.env("PATH", path);
            }
            command.env("RUSTC", rustc).env(TARGET_FLAGS, self.target_flags());
        }
        command.arg(subcommand).args(["--target", TARGET, "--target-dir"]).arg(&self.folder);
        command
    }
}

/// Folder in which cargo builds by default.
pub fn target_directory() -> PathBuf {
    let given = env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    workspace().join(given.unwrap_or_else(|| "target".into()))
}

/// Returns the compiler in use, if it has the target.
fn compiler_in_use(target_directory: &Path) -> Option<Toolchain> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    // The query must not make rustup download anything.
    let ask = |argument: &[&str]| {
        let mut command = Command::new(&rustc);
        command.args(argument).env("RUSTUP_AUTO_INSTALL", "0").current_dir(workspace());
        tool::capture_output(&mut command).ok()
    };
    let sysroot = ask(&["--print", "sysroot"])?;
    if !has_core(Path::new(sysroot.trim())) {
        return None;
    }
    let version = ask(&["--version", "--verbose"])?;
    is_new_enough(&version).then(|| Toolchain {
        cargo: env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from),
        rustc: None,
        sysroot: None,
        version,
        folder: target_directory.join("firmware/in-use"),
        target_directory: target_directory.to_path_buf(),
        is_for_release: false,
    })
}

fn has_core(sysroot: &Path) -> bool {
    let libraries = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    fs::read_dir(libraries).is_ok_and(|entries| {
        entries.flatten().any(|entry| {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            name.starts_with("libcore-") && name.ends_with(".rlib")
        })
    })
}

/// Returns a distribution's compiler with a private sysroot.
fn distribution(target_directory: PathBuf, say: Say<'_>) -> Outcome<Toolchain> {
    let version = match distribution_version() {
        Some(version) => version,
        None => {
            packages::ensure(&PACKAGES, "to build for the board", say).map_err(with_rustup_help)?;
            distribution_version().ok_or_else(|| {
                let (major, minor) = OLDEST_COMPILER;
                let message = format!(
                    "the packages {} contain no Rust compiler of version {major}.{minor} or later",
                    PACKAGES.join(" ")
                );
                with_rustup_help(Failure::new(message))
            })?
        }
    };
    let (cargo, rustc) = (PathBuf::from(DISTRIBUTION_CARGO), PathBuf::from(DISTRIBUTION_RUSTC));
    let sysroot = sysroot::prepare(&cargo, &rustc, &version, &target_directory, say)?;
    let name = sysroot.file_name().unwrap_or_default();
    let folder = target_directory.join("firmware").join(name);
    let (rustc, sysroot, is_for_release) = (Some(rustc), Some(sysroot), false);
    Ok(Toolchain { cargo, rustc, sysroot, version, folder, target_directory, is_for_release })
}

/// Version text of the distribution's compiler, if it is complete and new enough.
fn distribution_version() -> Option<String> {
    let complete = [DISTRIBUTION_CARGO, DISTRIBUTION_RUSTC].iter().all(|path| tool::is_program(Path::new(path)))
        && Path::new(LIBRARY_SOURCE).exists()
        && tool::find("ld.lld").is_some();
    if !complete {
        return None;
    }
    let version = tool::capture_output(Command::new(DISTRIBUTION_RUSTC).args(["--version", "--verbose"])).ok()?;
    is_new_enough(&version).then_some(version)
}

/// Adds rustup as the alternative to the help.
fn with_rustup_help(failure: Failure) -> Failure {
    let other = format!("or, with rustup and its network: rustup target add {TARGET}");
    let help = match failure.help() {
        Some(help) => format!("{help}\n{other}"),
        None => other,
    };
    failure.with_help(help)
}

fn is_new_enough(version: &str) -> bool {
    version_number(version).is_some_and(|number| number >= OLDEST_COMPILER)
}

/// Major and minor of "rustc 1.96.0 (...)".
fn version_number(version: &str) -> Option<(u32, u32)> {
    let mut numbers = version.strip_prefix("rustc ")?.split('.');
    Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The oldest compiler is accepted, the minor version before it is not.
    #[test]
    fn compiler_version_bound_inclusive() {
        let (major, minor) = OLDEST_COMPILER;
        assert!(is_new_enough(&format!("rustc {major}.{minor}.0 (abc 2026-01-01)")));
        assert!(!is_new_enough(&format!("rustc {major}.{}.1 (abc 2026-01-01)", minor - 1)));
        assert!(!is_new_enough("something else"));
    }

    /// The bound equals the workspace's `rust-version`.
    #[test]
    fn oldest_compiler_matches_manifest() {
        let manifest = fs::read_to_string(workspace().join("Cargo.toml")).unwrap();
        let (major, minor) = OLDEST_COMPILER;
        assert!(manifest.contains(&format!("rust-version = \"{major}.{minor}\"")));
    }

    /// A sysroot counts only if it holds `core` for the target.
    #[test]
    fn sysroot_without_target_rejected() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!has_core(folder.path()));
        let libraries = folder.path().join("lib/rustlib").join(TARGET).join("lib");
        fs::create_dir_all(&libraries).unwrap();
        assert!(!has_core(folder.path()));
        fs::write(libraries.join("libcore-0123.rlib"), "").unwrap();
        assert!(has_core(folder.path()));
    }

    /// The help names the distribution's packages and rustup.
    #[test]
    fn missing_compiler_help_has_both_remedies() {
        let failure = with_rustup_help(Failure::new("no compiler").with_help("run: sudo apt-get install lld"));
        let help = failure.help().unwrap();
        assert!(help.contains("apt-get install") && help.contains("rustup target add thumbv7em-none-eabihf"), "{help}");
    }
}

//! Installs missing packages on Debian-like systems if the user is root and agrees; otherwise shows the command to run.
//! On other systems the missing packages are named.

use std::env;
use std::fs::{self, File};
use std::io::{self, IsTerminal};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use clap::ValueEnum;
use report::failure::{Failure, Outcome};
use report::progress;

use super::{Say, tool};

/// Environment variable that decides about packages if `--install` is not given.
pub const INSTALL_VARIABLE: &str = "JOINT_INSTALL";

/// Decision about packages that are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Install {
    /// Installs them without a question
    Yes,
    /// Names them and the command that installs them, and ends
    No,
    /// Asks on a terminal; installs them where there is none
    Ask,
}

/// Decision of `--install`, for the whole process.
static DECISION: OnceLock<Install> = OnceLock::new();
/// Answer of the user, who is asked once.
static ANSWER: OnceLock<bool> = OnceLock::new();

/// Sets the decision of `--install` for the whole process; later calls have no effect.
pub fn set_decision(wanted: Option<Install>) {
    if let Some(wanted) = wanted {
        let _ = DECISION.set(wanted);
    }
}

impl Install {
    /// Returns the decision of `--install`, else of the environment variable.
    pub fn effective() -> Outcome<Self> {
        match DECISION.get() {
            Some(wanted) => Ok(*wanted),
            None => Self::from_variable(
                env::var_os(INSTALL_VARIABLE).map(|typed| typed.to_string_lossy().into_owned()).as_deref(),
            ),
        }
    }

    fn from_variable(typed: Option<&str>) -> Outcome<Self> {
        let Some(typed) = typed.filter(|typed| !typed.is_empty()) else { return Ok(Self::Ask) };
        Self::from_str(typed, true).map_err(|_| {
            Failure::new(format!("{INSTALL_VARIABLE}={typed} is invalid"))
                .with_help(format!("set {INSTALL_VARIABLE} to yes, no or ask, or leave it out"))
        })
    }

    /// Returns the word for the decision in `--install` and the environment variable.
    pub fn word(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::No => "no",
            Self::Ask => "ask",
        }
    }
}

/// Way to install packages on this system.
#[derive(Debug, Clone, PartialEq, Eq)]
enum PackageSource {
    /// apt-get, as root.
    Install(PathBuf),
    /// apt-get, but the user is not root.
    Ask,
    /// No apt-get.
    Unknown,
}

/// Installs packages that are missing. `purpose` completes "... needed ...", such as "to build for the board".
pub fn ensure(packages: &[&str], purpose: &str, say: Say<'_>) -> Outcome<()> {
    let source = package_source();
    let missing = || -> Vec<&str> {
        match source {
            PackageSource::Unknown => packages.to_vec(),
            _ => packages.iter().copied().filter(|package| !is_installed(package)).collect(),
        }
    };
    let before = missing();
    if before.is_empty() {
        return Ok(());
    }
    let install = Install::effective()?;
    let PackageSource::Install(apt_get_file) = &source else {
        return Err(not_installed(&source, &before.join(" "), purpose));
    };
    if install == Install::No {
        return Err(not_permitted(&before.join(" "), purpose));
    }
    let _lock = lock_installation(apt_get_file, say).map_err(|error| cannot_wait(&error))?;
    // Another process may have installed the packages during the wait.
    let missing = missing();
    if missing.is_empty() {
        return Ok(());
    }
    let list = missing.join(" ");
    let is_terminal = io::stdin().is_terminal() && io::stderr().is_terminal();
    let is_asking = install == Install::Ask;
    if is_asking && is_terminal && !*ANSWER.get_or_init(|| user_agrees(&list, purpose)) {
        return Err(not_permitted(&list, purpose));
    }
    let hint = if is_asking && !is_terminal {
        format!("; `--install no` or {INSTALL_VARIABLE}=no forbids that")
    } else {
        String::new()
    };
    say(&format!("installing {list} with apt-get, needed {purpose}{hint}"));
    tool::run_with_progress(apt_get().arg("update"), "apt-get update", say)
        .map_err(|failure| with_apt_get_help(failure, &list))?;
    let mut install = apt_get();
    install.args(["install", "--yes", "--no-install-recommends"]).args(&missing);
    tool::run_with_progress(&mut install, &format!("installing {list}"), say)
        .map_err(|failure| with_apt_get_help(failure, &list))
}

/// Waits for other commands of this project that install packages, in this or another process: of two concurrent
/// `apt-get update` one fails. The lock is on apt-get's own file, so that no lock file is needed.
fn lock_installation(apt_get_file: &Path, say: Say<'_>) -> io::Result<File> {
    let file = File::open(apt_get_file)?;
    tool::lock(&file, "another installation of packages", say)?;
    Ok(file)
}

fn cannot_wait(error: &io::Error) -> Failure {
    Failure::new(format!("cannot wait for other installations to end: apt-get: {error}"))
}

fn with_apt_get_help(failure: Failure, list: &str) -> Failure {
    failure.with_help(format!("fix the error of apt-get, then run: apt-get install {list}"))
}

/// Asks the user for permission to install packages; no answer means no.
fn user_agrees(list: &str, purpose: &str) -> bool {
    let question = format!(
        "{list} must be installed {purpose}: by apt-get, as root, for the whole system (`--install` and {INSTALL_VARIABLE} decide \
         without a question).\ninstall now? [y/N] "
    );
    progress::ask(&question).is_some_and(|answer| is_yes(&answer))
}

fn is_yes(answer: &str) -> bool {
    ["y", "yes"].contains(&answer.trim().to_lowercase().as_str())
}

/// Failure for packages that the user has not allowed to be installed.
fn not_permitted(list: &str, purpose: &str) -> Failure {
    Failure::new(format!("not installed, but needed {purpose}: {list}")).with_help(format!(
        "run: apt-get update && apt-get install {list}\nor allow it by `--install yes` or {INSTALL_VARIABLE}=yes"
    ))
}

fn not_installed(package_source: &PackageSource, list: &str, purpose: &str) -> Failure {
    let failure = Failure::new(format!("not installed, but needed {purpose}: {list}"));
    match package_source {
        PackageSource::Unknown => {
            failure.with_help("install the programs of these Debian packages with your system's package manager")
        }
        _ => failure.with_help(format!("run: sudo apt-get update && sudo apt-get install {list}")),
    }
}

fn package_source() -> PackageSource {
    match (tool::find("apt-get"), is_root()) {
        (None, _) => PackageSource::Unknown,
        (Some(file), true) => PackageSource::Install(file),
        (Some(_), false) => PackageSource::Ask,
    }
}

/// Returns whether the process runs as root: the owner of its `/proc` entry is its user.
fn is_root() -> bool {
    fs::metadata("/proc/self").is_ok_and(|data| data.uid() == 0)
}

fn is_installed(package: &str) -> bool {
    let status =
        tool::capture_output(Command::new("dpkg-query").args(["--show", "--showformat=${db:Status-Abbrev}", package]));
    status.is_ok_and(|status| status.starts_with("ii"))
}

/// apt-get command that waits up to five minutes for another installation.
fn apt_get() -> Command {
    let mut command = Command::new("apt-get");
    command.env("DEBIAN_FRONTEND", "noninteractive").args(["-o", "DPkg::Lock::Timeout=300"]);
    command
}

#[cfg(test)]
mod tests {
    use std::fs::TryLockError;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, mpsc};
    use std::time::Duration;

    use super::*;

    /// Without root the help is the exact command, and the exit code is 2.
    #[test]
    fn missing_package_without_root_shows_command() {
        let failure = not_installed(&PackageSource::Ask, "lld qemu-system-arm", "to run the emulated board");
        assert_eq!(failure.help(), Some("run: sudo apt-get update && sudo apt-get install lld qemu-system-arm"));
        assert!(failure.message().contains("to run the emulated board"));
        assert_eq!(failure.exit_code(), 2);
    }

    /// A second installation waits until the first has ended.
    #[test]
    fn concurrent_installation_waits() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("apt-get");
        fs::write(&program, "").unwrap();
        let first = lock_installation(&program, &|_| {}).unwrap();
        assert!(matches!(File::open(&program).unwrap().try_lock(), Err(TryLockError::WouldBlock)));
        let (waits, told) = mpsc::channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&is_over);
        let other = std::thread::spawn(move || {
            let _lock = lock_installation(&program, &|line| waits.send(line.to_owned()).unwrap()).unwrap();
            seen.load(Ordering::SeqCst)
        });
        assert_eq!(told.recv().unwrap(), "waiting for another installation of packages");
        // Longer than a thread that does not wait needs to reach its assertion.
        std::thread::sleep(Duration::from_millis(100));
        is_over.store(true, Ordering::SeqCst);
        drop(first);
        assert!(other.join().unwrap());
    }

    /// `JOINT_INSTALL` accepts yes, no and ask; an empty variable counts as unset.
    #[test]
    fn install_variable_accepts_three_words() {
        for (typed, wanted) in [(None, Install::Ask), (Some(""), Install::Ask), (Some("No"), Install::No)] {
            assert_eq!(Install::from_variable(typed).unwrap(), wanted, "{typed:?}");
        }
        for install in Install::value_variants() {
            assert_eq!(Install::from_variable(Some(install.word())).unwrap(), *install);
        }
        let failure = Install::from_variable(Some("never")).unwrap_err();
        assert!(failure.message().contains("JOINT_INSTALL=never"), "{failure}");
        assert!(failure.help().unwrap().contains("yes, no or ask"), "{failure}");
        assert_eq!(failure.exit_code(), 2);
    }

    /// Any answer but y or yes means no.
    #[test]
    fn only_yes_permits_installation() {
        assert!(["y\n", "Yes\n", " YES "].into_iter().all(is_yes));
        assert!(!["", "\n", "n\n", "yess\n", "no"].into_iter().any(is_yes));
    }

    /// The failure names the packages, and its help the command.
    #[test]
    fn refused_installation_names_command() {
        let failure = not_permitted("lld qemu-system-arm", "to run the emulated board");
        assert!(failure.message().contains("to run the emulated board: lld qemu-system-arm"), "{failure}");
        assert!(failure.help().unwrap().contains("apt-get install lld qemu-system-arm"), "{failure}");
        assert_eq!(failure.exit_code(), 2);
    }

    /// Without apt-get the packages are named and no command is offered.
    #[test]
    fn missing_packages_named_without_apt_get() {
        let failure = not_installed(&PackageSource::Unknown, "lld", "to build for the board");
        assert!(failure.message().contains("lld"), "{failure}");
        assert!(!failure.help().unwrap_or_default().contains("apt-get"));
    }
}

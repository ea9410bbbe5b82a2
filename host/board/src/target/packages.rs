//! Installs missing packages on Debian-like systems if the user is root; otherwise shows the command to run. On other
//! systems the missing packages are named.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use super::{Say, tool};
use report::failure::{Failure, Outcome};

/// How packages can be got here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PackageSource {
    /// apt-get, as root.
    Install,
    /// apt-get, but somebody else must be root.
    Ask,
    /// There is no apt-get.
    Unknown,
}

/// One at a time: apt-get refuses to run beside itself, and who waited may find that the packages have come meanwhile.
static INSTALLING: Mutex<()> = Mutex::new(());

/// Makes sure that packages are installed. `purpose` completes "... needed ...", such as "to build for the board".
pub fn ensure(packages: &[&str], purpose: &str, say: Say<'_>) -> Outcome<()> {
    let package_source = package_source();
    let _alone = INSTALLING.lock().unwrap_or_else(PoisonError::into_inner);
    let missing: Vec<&str> = match package_source {
        PackageSource::Unknown => packages.to_vec(),
        _ => packages.iter().copied().filter(|package| !is_installed(package)).collect(),
    };
    if missing.is_empty() {
        return Ok(());
    }
    let list = missing.join(" ");
    if package_source != PackageSource::Install {
        return Err(absent(package_source, &list, purpose));
    }
    say(&format!("installing {list} with apt-get, needed {purpose}"));
    tool::follow(apt_get().arg("update"), "apt-get update", say).map_err(|failure| with_line(failure, &list))?;
    let mut install = apt_get();
    install.args(["install", "--yes", "--no-install-recommends"]).args(&missing);
    tool::follow(&mut install, &format!("installing {list}"), say).map_err(|failure| with_line(failure, &list))
}

fn with_line(failure: Failure, list: &str) -> Failure {
    failure.with_help(format!("mend what apt-get complains about, then run: apt-get install {list}"))
}

fn absent(package_source: PackageSource, list: &str, purpose: &str) -> Failure {
    let failure = Failure::new(format!("not installed, but needed {purpose}: {list}"));
    match package_source {
        PackageSource::Unknown => {
            failure.with_help("install what these Debian packages hold, by your system's own means")
        }
        _ => failure.with_help(format!("run: sudo apt-get update && sudo apt-get install {list}")),
    }
}

fn package_source() -> PackageSource {
    match (tool::find("apt-get"), is_root()) {
        (None, _) => PackageSource::Unknown,
        (Some(_), true) => PackageSource::Install,
        (Some(_), false) => PackageSource::Ask,
    }
}

/// The owner of this process's entry is the user that it runs as.
fn is_root() -> bool {
    fs::metadata("/proc/self").is_ok_and(|data| data.uid() == 0)
}

fn is_installed(package: &str) -> bool {
    let status =
        tool::output_of(Command::new("dpkg-query").args(["--show", "--showformat=${db:Status-Abbrev}", package]));
    status.is_ok_and(|status| status.starts_with("ii"))
}

/// Another installation that is under way is waited for, up to five minutes: two commands may be started at once.
fn apt_get() -> Command {
    let mut command = Command::new("apt-get");
    command.env("DEBIAN_FRONTEND", "noninteractive").args(["-o", "DPkg::Lock::Timeout=300"]);
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_not_root_gets_the_exact_line_and_exit_code_2() {
        let failure = absent(PackageSource::Ask, "lld qemu-system-arm", "to run the emulated board");
        assert_eq!(failure.help(), Some("run: sudo apt-get update && sudo apt-get install lld qemu-system-arm"));
        assert!(failure.message().contains("to run the emulated board"));
        assert_eq!(failure.exit_code(), 2);
    }

    #[test]
    fn without_apt_get_the_packages_are_named() {
        let failure = absent(PackageSource::Unknown, "lld", "to build for the board");
        assert!(failure.message().contains("lld"), "{failure}");
        assert!(!failure.help().unwrap_or_default().contains("apt-get"));
    }
}

//! Emulated board: QEMU's `netduinoplus2` with its serial line on a Unix socket in a folder that only this user can
//! enter.
//!
//! The emulator never outlives its owner. Dropping [`Emulator`] kills the process and waits for its end. The process
//! has its own process group, so that Ctrl-C reaches only the owner, which ends the run and then drops the emulator. If
//! `setpriv` (util-linux) is installed, the kernel also kills the emulator when the thread that started it dies: start
//! it on a thread that lives as long as the run.

use std::fs::{self, File};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::{Say, packages, tool};
use report::failure::{Failure, Outcome};
use report::workspace::require_sources;

const PROGRAM: &str = "qemu-system-arm";
/// Debian package of the emulator.
const PACKAGE: &str = PROGRAM;
/// The emulated board: an STM32F405.
pub const MACHINE: &str = "netduinoplus2";
/// Eight nanoseconds per instruction, and no waiting for the host's clock while the processor sleeps: emulated time
/// depends on the instructions alone.
pub const CLOCK: &str = "shift=3,sleep=off";
/// Longest wait for the emulator to open its line.
const START_TIMEOUT: Duration = Duration::from_secs(20);
const POLL_INTERVAL: Duration = Duration::from_millis(5);
/// Longest name of a temporary folder that leaves room for the socket: a socket's path is limited to about a hundred
/// bytes.
const LONGEST_FOLDER_NAME: usize = 60;

/// A running emulated board.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    folder: TempDir,
    ended: Option<ExitStatus>,
}

/// Finds the emulator or installs it; returns its version line.
pub fn ensure(say: Say<'_>) -> Outcome<String> {
    require_sources("the emulated board's image")?;
    if tool::find(PROGRAM).is_none() {
        packages::ensure(&[PACKAGE], "to run the emulated board", say)?;
    }
    let version = tool::capture_output(Command::new(program()?).arg("--version"))?;
    Ok(version.lines().next().unwrap_or_default().to_owned())
}

impl Emulator {
    /// Boots an image. The board starts once the returned end of its serial line is connected, so that none of its
    /// output is lost.
    pub fn start(elf: &Path) -> Outcome<(Self, UnixStream)> {
        Self::start_with(&program()?, elf)
    }

    fn start_with(program: &Path, elf: &Path) -> Outcome<(Self, UnixStream)> {
        let folder = private_folder()?;
        let socket = folder.path().join("serial");
        let log = File::create(folder.path().join("log")).map_err(|error| folder_failure(&error))?;
        let mut command = killed_with_parent(program);
        // The board's UART buffers one byte; the multiplexer buffers the following ones, which doubles the rate. Its
        // escape character would be removed from the stream; 256 disables it.
        command
            .args(["-M", MACHINE, "-icount", CLOCK])
            .args(["-nodefaults", "-no-user-config", "-display", "none", "-monitor", "none"])
            .arg("-chardev")
            .arg(format!("socket,id=line,server=on,wait=on,mux=on,path={}", socket.display()))
            .args(["-echr", "256", "-serial", "chardev:line", "-kernel"])
            .arg(elf)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log)
            .process_group(0);
        let child =
            command.spawn().map_err(|error| Failure::new(format!("cannot run {}: {error}", program.display())))?;
        let mut emulator = Self { child, folder, ended: None };
        let line = emulator.connect(&socket)?;
        Ok((emulator, line))
    }

    /// Fails if the emulator has ended, with its output in the error. Call it whenever the line is silent or closed, so
    /// that the end of the process is reported at once.
    pub fn check(&mut self) -> Outcome<()> {
        if self.ended.is_none() {
            self.ended = self.child.try_wait().ok().flatten();
        }
        match self.ended {
            None => Ok(()),
            Some(status) => Err(Failure::new(format!("the emulator has ended ({status}){}", self.error_output()))),
        }
    }

    /// Process id of the emulator.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    fn connect(&mut self, socket: &Path) -> Outcome<UnixStream> {
        let deadline = Instant::now() + START_TIMEOUT;
        loop {
            match UnixStream::connect(socket) {
                Ok(line) => return Ok(line),
                Err(error) if Instant::now() > deadline => {
                    let message = format!("the emulator did not open its serial line: {error}{}", self.error_output());
                    return Err(Failure::new(message));
                }
                Err(_) => self.check()?,
            }
            thread::sleep(POLL_INTERVAL);
        }
    }

    /// Standard error of the emulator, without the message that it waits for a connection.
    fn error_output(&self) -> String {
        let said = fs::read_to_string(self.folder.path().join("log")).unwrap_or_default();
        said.lines().filter(|line| !line.contains("info: QEMU waiting")).map(|line| format!("\n{line}")).collect()
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // The process may have ended by itself; `wait` reaps it in both cases.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Path of the emulator's program.
pub(super) fn program() -> Outcome<PathBuf> {
    tool::find(PROGRAM).ok_or_else(|| {
        Failure::new(format!("{PROGRAM} is not on the search path")).with_help(format!("install {PACKAGE}"))
    })
}

/// Command for a program that the kernel kills when its parent thread dies, if `setpriv` is installed.
pub(super) fn killed_with_parent(program: &Path) -> Command {
    match tool::find("setpriv") {
        None => Command::new(program),
        Some(setpriv) => {
            let mut command = Command::new(setpriv);
            command.args(["--pdeathsig", "KILL", "--"]).arg(program);
            command
        }
    }
}

/// Creates a folder with a short name that only this user can enter.
fn private_folder() -> Outcome<TempDir> {
    let default_folder = std::env::temp_dir();
    let place =
        if default_folder.as_os_str().len() > LONGEST_FOLDER_NAME { PathBuf::from("/tmp") } else { default_folder };
    let owner_only = fs::Permissions::from_mode(0o700);
    tempfile::Builder::new()
        .prefix("joint-")
        .permissions(owner_only)
        .tempdir_in(place)
        .map_err(|error| folder_failure(&error))
}

fn folder_failure(error: &io::Error) -> Failure {
    Failure::new(format!("no temporary folder for the emulator's serial line: {error}"))
        .with_help("set TMPDIR to a folder that can be written")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stand-in for the emulator, as a shell script.
    fn script(folder: &Path, text: &str) -> PathBuf {
        let path = folder.join("stand-in");
        fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    fn is_alive(process: u32) -> bool {
        Path::new("/proc").join(process.to_string()).exists()
    }

    /// The failure of an emulator that ends at once carries its standard error.
    #[test]
    fn emulator_exit_at_start_shows_output() {
        let folder = tempfile::tempdir().unwrap();
        let program = script(folder.path(), "echo no such machine >&2; exit 1");
        let failure = Emulator::start_with(&program, Path::new("x.elf")).map(|_| ()).unwrap_err();
        assert!(failure.message().contains("no such machine"), "{failure}");
        assert_eq!(failure.exit_code(), 2);
    }

    /// Dropping the emulator ends its process and removes its folder.
    #[test]
    fn dropped_emulator_removes_process_folder() {
        let folder = private_folder().unwrap();
        let path = folder.path().to_owned();
        let child = killed_with_parent(Path::new("/bin/sleep")).arg("600").process_group(0).spawn().unwrap();
        let mut emulator = Emulator { child, folder, ended: None };
        let process = emulator.process_id();
        assert!(emulator.check().is_ok() && is_alive(process));
        drop(emulator);
        assert!(!is_alive(process) && !path.exists());
    }

    /// Every check after the emulator's end reports the exit status.
    #[test]
    fn emulator_exit_reported_every_check() {
        let child = Command::new("/bin/sh").args(["-c", "exit 7"]).spawn().unwrap();
        let mut emulator = Emulator { child, folder: private_folder().unwrap(), ended: None };
        let deadline = Instant::now() + START_TIMEOUT;
        while emulator.check().is_ok() && Instant::now() < deadline {
            thread::sleep(POLL_INTERVAL);
        }
        assert!(emulator.check().unwrap_err().message().contains("exit status: 7"));
        assert!(emulator.check().is_err());
    }

    /// The kernel kills the emulator when the thread that started it ends.
    #[test]
    fn emulator_killed_with_starter() {
        if tool::find("setpriv").is_none() {
            return;
        }
        let start = || {
            let child = killed_with_parent(Path::new("/bin/sleep")).arg("600").process_group(0).spawn().unwrap();
            let name = Path::new("/proc").join(child.id().to_string()).join("comm");
            while fs::read_to_string(&name).unwrap() != "sleep\n" {
                thread::sleep(POLL_INTERVAL);
            }
            child
        };
        let mut child = thread::spawn(start).join().unwrap();
        let deadline = Instant::now() + START_TIMEOUT;
        while child.try_wait().unwrap().is_none() && Instant::now() < deadline {
            thread::sleep(POLL_INTERVAL);
        }
        let ended = child.try_wait().unwrap();
        let _ = child.kill();
        let _ = child.wait();
        assert!(ended.is_some(), "still running");
    }

    /// Other users cannot enter the folder of the emulator's socket.
    #[test]
    fn socket_folder_private() {
        let folder = private_folder().unwrap();
        assert_eq!(folder.path().metadata().unwrap().permissions().mode() & 0o077, 0);
    }
}

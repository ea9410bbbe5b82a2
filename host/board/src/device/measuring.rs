//! Measuring binaries for the emulator: built for a list of joints and run to their end without a serial line; their
//! output comes through semihosting.

use std::env;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use super::Say;
use super::board::Chip;
use super::compile::{FIRMWARE_PACKAGE, compile, write_atomically};
use super::emulator::{self, MACHINE};
use super::toolchain::Toolchain;
use report::failure::{Failure, Outcome};
use report::interruption;

/// 64 ns per instruction against a timer of 168 MHz: 10.752 counts, so that the number of instructions is recovered
/// exactly.
const CLOCK: &str = "shift=6,sleep=off";
/// Last line of a complete run; a panic or a reset leaves it out.
const END: &str = "end of measurement";
/// Longest run; a normal run takes one to two minutes.
const TIMEOUT: Duration = Duration::from_secs(1200);
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Builds a measuring binary with the tables of the given joints; returns the ELF file.
pub fn build_measuring(
    toolchain: &Toolchain,
    binary: &str,
    joints: &[PathBuf],
    tick_rate: u32,
    say: Say<'_>,
) -> Outcome<PathBuf> {
    let list = env::join_paths(joints)
        .map_err(|error| Failure::new(format!("joint files cannot be listed for the firmware's build: {error}")))?;
    let rate = tick_rate.to_string();
    let environment = [("MEASURED_JOINTS", list.as_ref()), ("JOINT_TICK_RATE", rate.as_ref())];
    stored(toolchain, binary, &compile(toolchain, FIRMWARE_PACKAGE, binary, &measuring_features(), &environment, say)?)
}

fn stored(toolchain: &Toolchain, binary: &str, elf: &[u8]) -> Outcome<PathBuf> {
    let images = toolchain.target_directory().join("images");
    let place = images.join(format!("{binary}.elf"));
    write_atomically(&images, &place, elf)?;
    Ok(place)
}

/// Firmware features of measuring binaries: the emulated chip, and `measuring`.
pub(super) fn measuring_features() -> String {
    format!("{},measuring", Chip::Stm32f405.name())
}

/// Builds a measuring binary of another workspace package, with variables for its build; returns the ELF file.
pub fn build_other(
    toolchain: &Toolchain,
    package: &str,
    environment: &[(&str, &OsStr)],
    say: Say<'_>,
) -> Outcome<PathBuf> {
    stored(toolchain, package, &compile(toolchain, package, package, "", environment, say)?)
}

/// Runs a measuring binary and parses each of its lines.
pub fn read<R>(elf: &Path, mut parse: impl FnMut(&str) -> Option<R>) -> Outcome<Vec<R>> {
    let read = |line: &String| {
        parse(line).ok_or_else(|| Failure::new(format!("unexpected output of the measuring binary: {line}")))
    };
    run(elf)?.iter().map(read).collect()
}

/// Runs a measuring binary and returns its lines.
pub fn run(elf: &Path) -> Outcome<Vec<String>> {
    run_on(MACHINE, elf)
}

/// Runs a measuring binary on another machine of the emulator and returns its lines.
pub fn run_on(machine: &str, elf: &Path) -> Outcome<Vec<String>> {
    let mut command = emulator::killed_with_parent(&emulator::program()?);
    command
        .args(["-M", machine, "-icount", CLOCK, "-no-reboot"])
        .args(["-nodefaults", "-no-user-config", "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(elf)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .process_group(0);
    let child = command.spawn().map_err(|error| Failure::new(format!("cannot run the emulator: {error}")))?;
    let mut lines = Running(child).lines()?;
    match lines.pop() {
        Some(last) if last == END => Ok(lines),
        last => {
            let said: Vec<_> = lines.into_iter().chain(last).collect();
            Err(Failure::new(format!("{} ended early in the emulator:\n{}", elf.display(), said.join("\n"))))
        }
    }
}

/// Emulator process, killed when dropped.
struct Running(Child);

impl Running {
    /// Collects all lines until the process ends.
    fn lines(mut self) -> Outcome<Vec<String>> {
        let (sender, receiver) = mpsc::channel();
        let stdout = self.0.stdout.take();
        thread::spawn(move || {
            let lines = stdout.into_iter().flat_map(|stdout| BufReader::new(stdout).lines());
            lines.map_while(Result::ok).try_for_each(|line| sender.send(line))
        });
        let (mut lines, start) = (Vec::new(), Instant::now());
        loop {
            match receiver.recv_timeout(POLL_INTERVAL) {
                Ok(line) => lines.push(line),
                Err(RecvTimeoutError::Disconnected) => return Ok(lines),
                Err(RecvTimeoutError::Timeout) if interruption::requested() => {
                    return Err(Failure::interrupted("stopped by the user"));
                }
                Err(RecvTimeoutError::Timeout) if start.elapsed() > TIMEOUT => {
                    let minutes = TIMEOUT.as_secs() / 60;
                    return Err(Failure::new(format!(
                        "the measurement did not end in the emulator within {minutes} minutes"
                    )));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // The process may have ended by itself; `wait` reaps it in both cases.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

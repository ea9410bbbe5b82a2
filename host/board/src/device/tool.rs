//! Runs other programs: finds them, follows their output, and keeps it for an error.

use std::env;
use std::fs::{File, TryLockError};
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::Say;
use report::failure::{Failure, Outcome};

/// Text by which cargo reports that it waits for another cargo.
const CARGO_WAITING: &str = "Blocking waiting for file lock on";

/// Limit of a failed program's output in an error [lines].
const ERROR_LINES: usize = 60;

/// Path of a program on the search path.
pub fn find(name: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?).map(|folder| folder.join(name)).find(|path| is_program(path))
}

/// Cargo: the one that has started this program, else that of the search path.
pub fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Returns whether a path is an executable file.
pub fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    path.metadata().is_ok_and(|data| data.is_file() && data.permissions().mode() & 0o111 != 0)
}

/// Locks a file; if it is locked already, announces the wait for `holder`.
pub fn lock(file: &File, holder: &str, say: Say<'_>) -> io::Result<()> {
    if let Err(TryLockError::WouldBlock) = file.try_lock() {
        say(&format!("waiting for {holder}"));
    }
    file.lock()
}

/// Runs a program and returns its standard output.
pub fn capture_output(command: &mut Command) -> Outcome<String> {
    let name = name_of(command);
    let output = command.stdin(Stdio::null()).output().map_err(|error| cannot_run(&name, &error))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(Failure::new(format!("{name}: {}\n{}", output.status, said.trim_end())));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Runs a program and passes its standard error on line by line; the last lines are repeated in the error if it fails.
/// `what` names the action in the error.
pub fn run_with_progress(command: &mut Command, what: &str, say: Say<'_>) -> Outcome<()> {
    let name = name_of(command);
    let spawned = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
    let mut child = spawned.map_err(|error| cannot_run(&name, &error))?;
    let mut lines = Vec::new();
    if let Some(stderr) = child.stderr.take() {
        for line in BufReader::new(stderr).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line).into_owned();
            match line.trim().strip_prefix(CARGO_WAITING) {
                Some(what) => say(&format!("waiting for another cargo, which holds the {}", what.trim())),
                None => say(line.trim()),
            }
            lines.push(line);
        }
    }
    let status = child.wait().map_err(|error| cannot_run(&name, &error))?;
    if status.success() {
        return Ok(());
    }
    let shown = lines.len().saturating_sub(ERROR_LINES);
    Err(Failure::new(format!("{what} failed ({name}: {status})\n{}", lines[shown..].join("\n"))))
}

fn name_of(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}

fn cannot_run(name: &str, error: &std::io::Error) -> Failure {
    Failure::new(format!("cannot run {name}: {error}"))
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    /// The failure carries the program's standard error.
    #[test]
    fn failed_program_output_shown() {
        let failure = run_with_progress(&mut shell("echo no room >&2; exit 3"), "packing", &|_| {}).unwrap_err();
        assert!(failure.message().starts_with("packing failed"), "{failure}");
        assert!(failure.message().contains("no room"), "{failure}");
        assert_eq!(failure.exit_code(), 2);
    }

    /// Lines of standard error are passed on, those of standard output are not.
    #[test]
    fn program_output_passed_on() {
        let said = RefCell::new(Vec::new());
        let say = |line: &str| said.borrow_mut().push(line.to_owned());
        run_with_progress(&mut shell("echo one >&2; echo unseen; echo two >&2"), "counting", &say).unwrap();
        assert_eq!(*said.borrow(), ["one", "two"]);
    }

    /// Cargo's message about a lock is replaced by a plain one.
    #[test]
    fn cargo_wait_message_reworded() {
        let said = RefCell::new(Vec::new());
        let say = |line: &str| said.borrow_mut().push(line.to_owned());
        let script = "echo '    Blocking waiting for file lock on build directory' >&2";
        run_with_progress(&mut shell(script), "building", &say).unwrap();
        assert_eq!(*said.borrow(), ["waiting for another cargo, which holds the build directory"]);
    }

    /// The failure names a program that is not installed.
    #[test]
    fn missing_program_named() {
        let failure = capture_output(&mut Command::new("/no/such/program")).unwrap_err();
        assert!(failure.message().contains("/no/such/program"), "{failure}");
    }
}

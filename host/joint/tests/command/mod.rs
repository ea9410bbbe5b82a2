//! Runs the command `joint` as a user does and captures its output.

#![allow(dead_code, reason = "every test file uses a part of it")]

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// Result of a process.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; `None` if a signal ended the process.
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// Longest wait on a machine under load.
pub const TIMEOUT: Duration = Duration::from_secs(120);

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
    // The width prevents line breaks within the words that a test looks for.
    command.args(arguments).env("NO_COLOR", "1").env("COLUMNS", "400").stdin(Stdio::null());
    command
}

/// Runs the command to its end.
pub fn joint(arguments: &[&str]) -> Ended {
    ended(command(arguments).output().expect("the command can be started"))
}

/// Runs the command in a folder.
pub fn joint_in(folder: &Path, arguments: &[&str]) -> Ended {
    ended(command(arguments).current_dir(folder).output().expect("the command can be started"))
}

/// Runs the command with environment variables.
pub fn joint_with(arguments: &[&str], variables: &[(&str, &str)]) -> Ended {
    ended(command(arguments).envs(variables.iter().copied()).output().expect("the command can be started"))
}

/// Runs the command with a limit on the size of every file [KiB], which acts like a full disk.
pub fn joint_on_a_full_disk(blocks: u32, arguments: &[&str]) -> Ended {
    joint_on_a_full_disk_with(blocks, arguments, &[])
}

/// Runs the command with a limit on the size of every file [KiB] and with environment variables.
pub fn joint_on_a_full_disk_with(blocks: u32, arguments: &[&str], variables: &[(&str, &str)]) -> Ended {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("bash");
    shell.args(["-c", &script, env!("CARGO_BIN_EXE_joint")]).args(arguments).stdin(Stdio::null());
    shell.env("NO_COLOR", "1").env("COLUMNS", "400").envs(variables.iter().copied());
    ended(shell.output().expect("a shell"))
}

/// Starts the command in the background.
pub fn start(arguments: &[&str]) -> Child {
    command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command can be started")
}

/// Waits for the end of the command.
pub fn wait(child: Child) -> Ended {
    ended(child.wait_with_output().expect("it was started here"))
}

/// Sends the signal of Ctrl-C.
pub fn interrupt(child: &Child) {
    send("-INT", child);
}

/// Sends a signal to a process.
pub fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("`kill` is there");
    assert!(sent.success());
}

/// Waits until a condition holds.
pub fn until(what: &str, mut so: impl FnMut() -> bool) {
    within(TIMEOUT, what, || so().then_some(()));
}

/// Waits for a result, which must come within the limit.
pub fn within<T>(limit: Duration, what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = found() {
            return found;
        }
        assert!(start.elapsed() < limit, "{what}: not after {limit:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Size of a file [bytes], 0 if it does not exist.
pub fn size(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |data| data.len())
}

/// Path as an argument.
pub fn text(path: &(impl AsRef<OsStr> + ?Sized)) -> &str {
    path.as_ref().to_str().expect("temporary folders have plain names")
}

/// Temporary folder, removed when dropped.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Rows of a simulated log of Q1 that hold the quick reversals, identified in a sixth of the time of the whole log.
pub const QUICK_ROWS: usize = 38_000;
/// Rows of a simulated log of Q1 that hold the quick reversals and the first slow one: they show every parameter and are
/// identified in a third of the time of the whole log.
pub const SHORT_ROWS: usize = 54_000;

/// Writes the first rows of a simulated log of Q1.
pub fn write_short_log(path: &Path, rows: usize) {
    let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
    let whole = identify::virtual_test::record(&q1, 1, &|_| {}).expect("can be followed").csv(false);
    std::fs::write(path, first_rows(&whole, rows)).expect("room");
}

/// Header and first rows of a log.
pub fn first_rows(log: &str, rows: usize) -> String {
    log.lines().take(1 + rows).map(|line| format!("{line}\n")).collect()
}

/// Reads a JSON file.
pub fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("it was written")).expect("JSON, all of it")
}

/// Names and contents of all files of a folder.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file())
        .map(|path| (text(path.file_name().expect("a name")).to_owned(), std::fs::read(&path).expect("a file")))
        .collect();
    files.sort();
    files
}

impl Ended {
    /// Asserts exit code 2 (bad input) with all these words in the message, and no panic.
    #[track_caller]
    pub fn refused(&self, words: &[&str]) {
        self.exited(2, words);
    }

    /// Asserts an exit code with all these words in the message, and no panic.
    #[track_caller]
    pub fn exited(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:?}");
        // Underlined messages are broken into lines beside a drawn rule.
        let plain = self.err.replace(['│', '╰', '─', '├', '▶'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
        for word in words {
            assert!(plain.contains(word), "`{word}` is not in: {plain}");
        }
        assert!(!self.err.contains("panicked"), "{self:?}");
    }

    /// Asserts success.
    #[track_caller]
    pub fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }
}

fn ended(output: std::process::Output) -> Ended {
    Ended {
        code: output.status.code(),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

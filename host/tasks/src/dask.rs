//! Tasks on the workers of a Dask scheduler. The client is the Python module `lostmotion.dask`: it submits every task
//! without a result, writes the results into the folder, and reports each step as a line of JSON.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use serde::Deserialize;

use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;

/// Environment variable with the Python that has the packages; the wheel's command sets it to its own.
const PYTHON: &str = "JOINT_PYTHON";
/// Remedy for a Python without the packages.
const NEEDS: &str = "the wheel and Dask must be in one Python: pip install lostmotion-*.whl distributed; JOINT_PYTHON names another Python than python3";
/// Interval of the checks for Ctrl-C.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// Line of the client.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Event {
    /// A task has its result.
    Done,
    /// Remark for the user.
    Remark(String),
    /// The client ends with this failure.
    Failed {
        /// Cause.
        message: String,
        /// Remedy.
        help: String,
    },
}

/// Python that has the packages.
pub fn python() -> String {
    std::env::var(PYTHON).ok().filter(|name| !name.is_empty()).unwrap_or_else(|| "python3".to_owned())
}

/// Runs every task of a folder that has no result.
pub fn run(address: &str, folder: &Path, progress: &Progress) -> Outcome<()> {
    run_with(&python(), address, folder, progress)
}

pub(crate) fn run_with(python: &str, address: &str, folder: &Path, progress: &Progress) -> Outcome<()> {
    let mut command = Command::new(python);
    command.args(["-m", "lostmotion.dask", address]).arg(folder);
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| Failure::new(format!("cannot start {python} for --dask: {error}")).with_help(NEEDS))?;
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let (child, ended) = (Mutex::new(child), AtomicBool::new(false));
    let (failure, last_words) = thread::scope(|scope| {
        scope.spawn(|| end_on_request(&child, &ended));
        let words = scope.spawn(|| last_line(stderr));
        let mut failure = None;
        for line in stdout.into_iter().flat_map(|stdout| BufReader::new(stdout).lines()).map_while(Result::ok) {
            match serde_json::from_str(&line) {
                Ok(Event::Done) => progress.advance(1),
                Ok(Event::Remark(remark)) => progress.print_message(&remark),
                Ok(Event::Failed { message, help }) => failure = Some(Failure::new(message).with_help(help)),
                Err(_) => {}
            }
        }
        ended.store(true, Ordering::SeqCst);
        (failure, words.join().unwrap_or_default())
    });
    let status = child.into_inner().unwrap_or_else(PoisonError::into_inner).wait();
    if interruption::requested() {
        return Err(Failure::interrupted("stopped by the user"));
    }
    match (failure, status) {
        (Some(failure), _) => Err(failure),
        (None, Ok(status)) if status.success() => Ok(()),
        (None, Ok(status)) => {
            Err(Failure::new(format!("the Dask client of {python} ended with {status}: {last_words}")).with_help(NEEDS))
        }
        (None, Err(error)) => Err(Failure::new(format!("the Dask client of {python} was lost: {error}"))),
    }
}

/// Ends the client when the user stops this process; the client gets Ctrl-C of a terminal itself, but no other signal.
fn end_on_request(child: &Mutex<Child>, ended: &AtomicBool) {
    while !ended.load(Ordering::SeqCst) {
        if interruption::requested() {
            // A client that has just ended needs no signal.
            let _ = child.lock().unwrap_or_else(PoisonError::into_inner).kill();
            return;
        }
        thread::sleep(CHECK_INTERVAL);
    }
}

/// Last line that is not empty.
fn last_line(stderr: Option<ChildStderr>) -> String {
    let mut text = Vec::new();
    // What was read before an error still helps.
    let _ = stderr.map(|mut stderr| stderr.read_to_end(&mut text));
    let text = String::from_utf8_lossy(&text);
    text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default().trim().to_owned()
}

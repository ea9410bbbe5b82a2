//! Ctrl-C, SIGTERM and SIGHUP: the first signal ends work that leaves no partial results at once, and asks other work
//! to finish in order; the second signal ends the process immediately.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::failure::{EXIT_INTERRUPTED, Failure, Outcome};

/// Time after which the process ends if no work must finish in order. Users do not notice a delay of 0.2 s; the
/// remainder is for a busy machine to schedule this process.
const EXIT_DELAY: Duration = Duration::from_millis(80);
/// Interval of the checks for work that must finish in order.
const CHECK_INTERVAL: Duration = Duration::from_millis(5);

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static LEFT_TO_HOST: AtomicBool = AtomicBool::new(false);
static ORDERLY_TASKS: AtomicUsize = AtomicUsize::new(0);
static WATCH: OnceLock<Result<(), String>> = OnceLock::new();

/// Leaves the signals to the program that runs this code as a library; that program calls [`request`].
pub fn leave_to_host() {
    LEFT_TO_HOST.store(true, Ordering::SeqCst);
}

/// Asks the work of this process to stop, as a signal does; `false` withdraws the request for later work.
pub fn request(stop: bool) {
    INTERRUPTED.store(stop, Ordering::SeqCst);
}

/// Installs the signal handler, once for the process.
pub fn watch() -> Outcome<()> {
    if LEFT_TO_HOST.load(Ordering::SeqCst) {
        return Ok(());
    }
    let listen = || {
        ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(EXIT_INTERRUPTED.into());
            }
            thread::spawn(exit_when_idle);
        })
        .map_err(|error| error.to_string())
    };
    WATCH.get_or_init(listen).clone().map_err(|error| Failure::new(format!("cannot listen for Ctrl-C: {error}")))
}

/// Returns true if the user wants to stop.
pub fn requested() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// Marks work that must not be cut off, such as writing a file or driving a board. The process waits while a value of
/// this type exists; the work itself checks [`requested`].
#[derive(Debug)]
#[must_use = "the process waits for as long as this lives"]
pub struct UninterruptedWork(());

impl UninterruptedWork {
    /// Starts the marked work.
    pub fn begin() -> Self {
        ORDERLY_TASKS.fetch_add(1, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for UninterruptedWork {
    fn drop(&mut self) {
        ORDERLY_TASKS.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Ends the process once no marked work has been active for a while. Reading, fitting and drawing leave no partial
/// results, so their loops, here or in a library, need no checks.
fn exit_when_idle() {
    // Measured by the clock: on a busy machine a sleep takes longer than requested.
    let mut idle_since = Instant::now();
    while idle_since.elapsed() < EXIT_DELAY {
        thread::sleep(CHECK_INTERVAL);
        if ORDERLY_TASKS.load(Ordering::SeqCst) > 0 {
            idle_since = Instant::now();
        }
    }
    Failure::interrupted("stopped by the user").show();
    std::process::exit(EXIT_INTERRUPTED.into());
}

/// Replaces a failure by an interruption if the user wants to stop: child processes may have received the signal too
/// and failed because of it.
pub fn explain<T>(outcome: Outcome<T>) -> Outcome<T> {
    match outcome {
        Err(failure) if requested() && failure.exit_code() != EXIT_INTERRUPTED => {
            Err(Failure::interrupted("stopped by the user"))
        }
        outcome => outcome,
    }
}

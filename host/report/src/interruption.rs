//! Ctrl-C and a polite request to end (SIGTERM, SIGHUP): the first ends work that leaves nothing behind within a moment,
//! and asks work that must end in order to do so; the second ends the process at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::failure::{EXIT_INTERRUPTED, Failure, Outcome};

/// Time in which work that need not end in order ends by itself. A command is to end within 0.2 s, which users do not notice; a busy
/// machine has the rest to let this process run.
const PATIENCE: Duration = Duration::from_millis(80);
/// Time between two looks at whether work must still end in order.
const LOOK: Duration = Duration::from_millis(5);

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static IN_ORDER: AtomicUsize = AtomicUsize::new(0);
static WATCH: OnceLock<Result<(), String>> = OnceLock::new();

/// Starts to listen, once for the process.
pub fn watch() -> Outcome<()> {
    let listen = || {
        ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(EXIT_INTERRUPTED.into());
            }
            thread::spawn(end_what_does_not_listen);
        })
        .map_err(|error| error.to_string())
    };
    WATCH.get_or_init(listen).clone().map_err(|error| Failure::new(format!("cannot listen for Ctrl-C: {error}")))
}

/// Whether the user wants to stop.
pub fn requested() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// Work that would leave something half done behind if the process ended in the midst of it: a file that is being written, a
/// board that is being driven. As long as one of these lives the process waits; the work looks at [`requested`] by itself.
#[derive(Debug)]
#[must_use = "the process waits for as long as this lives"]
pub struct InOrder(());

impl InOrder {
    /// From here on.
    pub fn begin() -> Self {
        IN_ORDER.fetch_add(1, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for InOrder {
    fn drop(&mut self) {
        IN_ORDER.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Ends the process once nothing has had to end in order for a while: reading, fitting and drawing leave nothing behind, and
/// no loop of theirs, here or in a library, has to look whether it may go on.
fn end_what_does_not_listen() {
    // By the clock: on a busy machine a pause is longer than it was asked to be.
    let mut unheard_since = Instant::now();
    while unheard_since.elapsed() < PATIENCE {
        thread::sleep(LOOK);
        if IN_ORDER.load(Ordering::SeqCst) > 0 {
            unheard_since = Instant::now();
        }
    }
    Failure::interrupted("stopped by the user").show();
    std::process::exit(EXIT_INTERRUPTED.into());
}

/// What a failure means if the user wants to stop: programs that were started here may have been told so too, and
/// then their failure is not the point.
pub fn explain<T>(outcome: Outcome<T>) -> Outcome<T> {
    match outcome {
        Err(failure) if requested() && failure.exit_code() != EXIT_INTERRUPTED => {
            Err(Failure::interrupted("stopped by the user"))
        }
        outcome => outcome,
    }
}

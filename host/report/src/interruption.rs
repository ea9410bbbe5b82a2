//! Ctrl-C and a polite request to end (SIGTERM, SIGHUP): the first asks the work under way to end in order, the second
//! ends the process at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{EXIT_INTERRUPTED, Failure, Outcome};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static WATCH: OnceLock<Result<(), String>> = OnceLock::new();

/// Starts to listen, once for the process.
pub fn watch() -> Outcome<()> {
    let listen = || {
        ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(EXIT_INTERRUPTED.into());
            }
        })
        .map_err(|error| error.to_string())
    };
    WATCH.get_or_init(listen).clone().map_err(|error| Failure::new(format!("cannot listen for Ctrl-C: {error}")))
}

/// Whether the user wants to stop.
pub fn requested() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
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

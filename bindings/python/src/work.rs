//! Long work without Python's lock, beside Ctrl-C.

use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use report::failure::Outcome;
use report::{interruption, output};

use crate::failure;

/// Interval at which Python's signals are looked at.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(20);

/// Held by the running work: a request to stop is for the whole process.
static RUNNING: Mutex<()> = Mutex::new(());

/// Runs work of the host's crates in a thread of its own. After Ctrl-C the exception is raised at once; the work is asked
/// to stop, and the next work waits for its end.
pub fn run<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> Outcome<T> + Send + 'static) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    let quiet_work = move || {
        let _running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        interruption::leave_to_host();
        // A request may have come after the end of the work before.
        interruption::request(false);
        output::silence();
        let outcome = work();
        let _ = sender.send(outcome);
    };
    thread::Builder::new()
        .name("lostmotion".to_owned())
        .spawn(quiet_work)
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    let receiver = Mutex::new(receiver);
    loop {
        let waited =
            py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(SIGNAL_INTERVAL));
        match waited {
            Ok(outcome) => return failure::result(py, outcome),
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result: this is a bug"));
            }
            Err(mpsc::RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    interruption::request(true);
                    return Err(signal);
                }
            }
        }
    }
}

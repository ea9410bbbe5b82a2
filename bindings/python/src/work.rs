//! Long work without Python's lock, beside Ctrl-C, in the standard mode of the floating-point unit. The threads of rayon
//! begin in that mode, since such work starts them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
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

/// State of the work of one call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Earlier work holds [`RUNNING`].
    Waiting,
    /// The work holds [`RUNNING`]: a request to stop reaches it and no other work.
    Running,
    /// The work has returned.
    Ended,
    /// The caller has left: waiting work must not begin.
    Abandoned,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Begins work that holds [`RUNNING`]; false if its caller has left.
fn begin(state: &Mutex<State>) -> bool {
    let mut state = locked(state);
    if *state == State::Abandoned {
        return false;
    }
    *state = State::Running;
    interruption::leave_to_host();
    // A request may have come after the end of the work before.
    interruption::request(false);
    output::silence();
    true
}

/// Abandons the work of a call: running work is asked to stop, waiting work never begins.
fn abandon(state: &Mutex<State>) {
    let mut state = locked(state);
    if *state == State::Running {
        interruption::request(true);
    }
    *state = State::Abandoned;
}

/// Runs work of the host's crates in a thread of its own. After Ctrl-C the exception is raised at once; running work is
/// asked to stop, and the next work waits for its end; waiting work is dropped.
pub fn run<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> Outcome<T> + Send + 'static) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    let state = Arc::new(Mutex::new(State::Waiting));
    let of_worker = Arc::clone(&state);
    let quiet_work = move || {
        let _running = locked(&RUNNING);
        if begin(&of_worker) {
            let outcome = fp_mode::standard(work);
            *locked(&of_worker) = State::Ended;
            let _ = sender.send(outcome);
        }
    };
    thread::Builder::new()
        .name("lostmotion".to_owned())
        .spawn(quiet_work)
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    let receiver = Mutex::new(receiver);
    loop {
        let waited = py.detach(|| locked(&receiver).recv_timeout(SIGNAL_INTERVAL));
        match waited {
            Ok(outcome) => return failure::result(py, outcome),
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result: this is a bug"));
            }
            Err(mpsc::RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    abandon(&state);
                    return Err(signal);
                }
            }
        }
    }
}

/// Runs short work in the calling thread, without Python's lock and beside long work.
pub fn short<T: Send>(py: Python<'_>, work: impl FnOnce() -> Outcome<T> + Send) -> PyResult<T> {
    let outcome = py.detach(|| {
        output::silence();
        fp_mode::standard(work)
    });
    failure::result(py, outcome)
}

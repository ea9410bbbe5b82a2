//! Gate of the clients' bytes: readers wait while a twin that is behind or a bus that is busy has bytes left to handle.
//! The clients' writes then wait as well, as those to an adapter with a full buffer do, and no frame is lost.

use std::sync::{Arc, Condvar, Mutex, PoisonError};

/// Bytes of clients on their way to the twin, beyond which no more are read.
const MAX_PENDING: usize = 64 << 10;

/// State of the gate.
#[derive(Debug, Default)]
struct State {
    /// Bytes that were read and are not handled yet.
    pending: usize,
    /// True while the bus is too busy for more frames.
    is_closed: bool,
}

/// Gate that readers and the session share.
#[derive(Debug, Clone, Default)]
pub struct Gate(Arc<(Mutex<State>, Condvar)>);

impl Gate {
    /// Waits until bytes may be read.
    pub fn wait(&self) {
        let (state, changed) = &*self.0;
        let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
        while state.is_closed || state.pending >= MAX_PENDING {
            state = changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Notes bytes that were read.
    pub fn read(&self, count: usize) {
        self.change(|state| state.pending += count);
    }

    /// Notes bytes that were handled.
    pub fn handled(&self, count: usize) {
        self.change(|state| state.pending = state.pending.saturating_sub(count));
    }

    /// Opens or closes the gate.
    pub fn set(&self, is_open: bool) {
        self.change(|state| state.is_closed = !is_open);
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        let (state, changed) = &*self.0;
        change(&mut state.lock().unwrap_or_else(PoisonError::into_inner));
        changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::thread;
    use std::time::Duration;

    #[test]
    fn full_gate_lets_readers_wait() {
        let gate = Gate::default();
        gate.wait();
        gate.read(MAX_PENDING);
        let (sender, passed) = channel();
        let reader = gate.clone();
        thread::spawn(move || {
            reader.wait();
            sender.send(())
        });
        assert!(passed.recv_timeout(Duration::from_millis(50)).is_err());
        gate.set(false);
        gate.handled(1);
        assert!(passed.recv_timeout(Duration::from_millis(50)).is_err());
        gate.set(true);
        passed.recv_timeout(Duration::from_secs(60)).expect("the gate is open");
    }
}

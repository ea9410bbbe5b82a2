//! Safe state: enable output off and no further step, so no further torque, latched until a `Reset` message. A chip
//! reset ends in [`State::Stopped`] and loses the cause. The callers check the conditions that trip it.

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use link::messages::Trip;

/// State of the board.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// No run; a `Reset` message starts a run.
    Stopped,
    /// A run goes on; the enable output is on.
    Running,
    /// Safe state; only a `Reset` message starts a run, and with bad tables no run starts.
    Tripped(Trip),
}

/// Owner of the enable output: the output is on in [`State::Running`] only.
#[derive(Debug)]
pub struct SafeState<E> {
    enable: E,
    state: State,
}

impl<E: OutputPin<Error = Infallible>> SafeState<E> {
    /// Stopped state; switches the output off.
    pub fn new(mut enable: E) -> Self {
        let Ok(()) = enable.set_low();
        Self { enable, state: State::Stopped }
    }

    /// State of the board.
    pub fn state(&self) -> State {
        self.state
    }

    /// Starts a run; always refused once the tables were found bad.
    pub fn run(&mut self) -> Result<(), Trip> {
        if let State::Tripped(Trip::BadDigest) = self.state {
            return Err(Trip::BadDigest);
        }
        self.state = State::Running;
        let Ok(()) = self.enable.set_high();
        Ok(())
    }

    /// Ends a run; a trip stays latched.
    pub fn stop(&mut self) {
        let Ok(()) = self.enable.set_low();
        if self.state == State::Running {
            self.state = State::Stopped;
        }
    }

    /// Enters the safe state. The first trip is kept: later trips follow from it.
    pub fn trip(&mut self, trip: Trip) {
        let Ok(()) = self.enable.set_low();
        if !matches!(self.state, State::Tripped(_)) {
            self.state = State::Tripped(trip);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Pin(Option<bool>);

    impl embedded_hal::digital::ErrorType for Pin {
        type Error = Infallible;
    }

    impl OutputPin for Pin {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.0 = Some(false);
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.0 = Some(true);
            Ok(())
        }
    }

    #[test]
    fn enable_output_low_at_start() {
        assert_eq!(SafeState::new(Pin(None)).enable.0, Some(false));
    }

    #[test]
    fn enable_output_on_only_in_run() {
        let mut safe_state = SafeState::new(Pin(None));
        safe_state.run().unwrap();
        assert_eq!(safe_state.enable.0, Some(true));
        safe_state.stop();
        assert_eq!((safe_state.enable.0, safe_state.state()), (Some(false), State::Stopped));
        safe_state.run().unwrap();
        safe_state.trip(Trip::CommandLoss { tick: 7 });
        assert_eq!(safe_state.enable.0, Some(false));
    }

    #[test]
    fn first_fault_kept_until_next_run() {
        let mut safe_state = SafeState::new(Pin(None));
        safe_state.trip(Trip::NotFinite { tick: 3 });
        safe_state.trip(Trip::QueueFull);
        safe_state.stop();
        assert_eq!(safe_state.state(), State::Tripped(Trip::NotFinite { tick: 3 }));
        assert_eq!(safe_state.run(), Ok(()));
        assert_eq!(safe_state.state(), State::Running);
    }

    #[test]
    fn bad_tables_never_run() {
        let mut safe_state = SafeState::new(Pin(None));
        safe_state.trip(Trip::BadDigest);
        assert_eq!(safe_state.run(), Err(Trip::BadDigest));
        assert_eq!(safe_state.enable.0, Some(false));
    }
}

//! Integrator of a switched system: smooth within a discrete mode, restarted at every event that changes the mode
//! (teeth touch or part). Independent of gears and units; keeps no history.
//!
//! `system` defines the system, `guard` the functions whose zeros are events; `adaptive` takes error-controlled steps
//! of `dormand_prince`, and `event` finds the event at which a step must end.

mod adaptive;
mod dormand_prince;
mod event;
mod guard;
mod system;

pub use adaptive::{Counters, IntegrationError, Integrator};
pub use guard::{Guard, Guards, MAX_GUARDS};
pub use system::{Entries, MAX_ENTRIES, SwitchedSystem};

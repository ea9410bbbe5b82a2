//! Integration of a switched system: smooth within a discrete mode, restarted at every event that changes the mode (a tooth
//! touches or parts). It depends on no gears and no units, and keeps no history.
//!
//! `system` defines the system, `guard` the functions whose zeros are events; `adaptive` takes steps of
//! `dormand_prince` as long as the error allows, and `event` finds where one must end.

mod adaptive;
mod dormand_prince;
mod event;
mod guard;
mod system;

pub use adaptive::{Counters, IntegrationError, Integrator};
pub use guard::{Guard, Guards, MAX_GUARDS};
pub use system::{Entries, MAX_ENTRIES, SwitchedSystem};

//! Integrates a system whose right-hand side is smooth as long as some choices are frozen, restarting at every moment
//! at which a choice changes (a tooth touches or parts). Knows no gears and no units, and keeps no history.
//!
//! `system` is what is integrated, `guard` what tells that a choice no longer holds; `adaptive` takes steps of
//! `dormand_prince` as long as the error allows, and `event` finds where one must end.

mod adaptive;
mod dormand_prince;
mod event;
mod guard;
mod system;

pub use adaptive::{Counters, IntegrationError, Integrator};
pub use guard::{Guard, Guards, MAX_GUARDS};
pub use system::{Entries, MAX_ENTRIES, SwitchedSystem};

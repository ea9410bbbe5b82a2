//! Wiring check: compares signs, counts, ratio, torque scale, rate and clock of a joint with its tables before control
//! starts. `joint replay` feeds [`WiringJudge`] with a log; [`WiringCheck`] drives the motor gently and feeds the judge
//! with that motion.
//!
//! The check does not use the observer, only raw counts, times and torques.
//!
//! Indistinguishable for any check of this kind:
//!
//! - motor encoder, output encoder and torque all reversed: a joint with the opposite positive direction;
//! - two of the three reversed, and the third reversed;
//! - without an output encoder: motor encoder and torque reversed; another ratio; other counts of the motor encoder,
//!   and another torque scale;
//! - a ratio wrong by a power of two, and an encoder with another number of bits;
//! - both encoders with equally many excess bits, and a torque scale wrong by a power of two;
//! - a wrong torque scale, and a link of another inertia, as far as the link's inertia matters.

mod check;
#[cfg(feature = "design")]
pub mod design;
mod judge;
mod line;
pub mod tables;
pub(super) mod thresholds;
mod track;
mod verdict;

pub use check::{WiringCheck, WiringProgress, WiringRefusal};
pub use judge::WiringJudge;
pub use tables::WiringTable;
pub use verdict::{WIRING_ITEMS, Wiring, WiringItem, WiringVerdict};

//! Wiring check: whether signs, counts, ratio, torque scale, rate and clock of a joint are those of its tables, before
//! anything is controlled. `joint replay` feeds [`WiringJudge`] with a log; [`WiringCheck`] drives the motor gently and feeds
//! it with that motion.
//!
//! It does not use the observer: only raw counts, times and torques count.
//!
//! What no check of this kind can tell apart:
//!
//! - motor encoder, output encoder and torque reversed all three: that is a joint whose positive direction is the other one;
//! - two of them reversed, which looks like the third one reversed;
//! - without an output encoder: motor encoder and torque reversed, another ratio, other counts of the motor encoder beside
//!   another torque scale;
//! - a ratio that is off by a power of two, and an encoder with other bits;
//! - both encoders with as many bits too many, and a torque scale that is off by a power of two;
//! - a torque scale, and a link of another inertia, as far as the link's inertia counts.

mod check;
#[cfg(feature = "design")]
pub mod design;
mod judge;
mod line;
pub mod tables;
mod track;
mod verdict;

pub use check::{WiringCheck, WiringProgress, WiringRefusal};
pub use judge::WiringJudge;
pub use tables::WiringTable;
pub use verdict::{Verdict, WIRING_ITEMS, Wiring, WiringItem};

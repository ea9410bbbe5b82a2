//! A simulated joint in real time for tests of a controller: the gears' fixed step with motor, frictions and encoders, and
//! faults between joint and controller.

#[cfg(feature = "design")]
pub mod design;
pub mod fault;
pub mod faults;
mod plant;
pub mod tables;

pub use plant::{ActingTorques, VirtualJoint};
pub use tables::SurroundingsTable;

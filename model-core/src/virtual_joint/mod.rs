//! A whole joint in real time, for a controller to be tried on: the gears' fixed step with what surrounds it, and faults
//! between the two.

#[cfg(feature = "design")]
pub mod design;
pub mod fault;
pub mod faults;
mod plant;
pub mod tables;

pub use plant::{Acting, VirtualJoint};
pub use tables::SurroundingsTable;

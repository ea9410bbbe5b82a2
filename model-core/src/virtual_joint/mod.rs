//! A whole joint in real time, for a controller to be tried on: the gears' fixed step with what surrounds it, and faults
//! between the two.

#[cfg(feature = "design")]
pub mod design;
mod plant;
pub mod tables;
pub mod upset;

pub use plant::{Acting, VirtualJoint};
pub use tables::SurroundingsTable;

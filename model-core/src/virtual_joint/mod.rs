//! Real-time simulation of a joint for tests of a controller: the fixed step of the gears with motor, frictions and
//! encoders, and faults between joint and controller.

#[cfg(feature = "design")]
pub mod design;
pub mod fault;
pub mod fault_injector;
mod plant;
pub mod tables;

pub use plant::{ActingTorques, VirtualJoint};
pub use tables::{SurroundingsTable, VirtualJointDesign};

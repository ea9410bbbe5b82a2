//! Real-time simulation of a joint for tests of a controller: the fixed step of the gears with motor, frictions and
//! encoders, and faults between joint and controller.

#[cfg(feature = "design")]
pub mod design;
#[cfg(test)]
mod driven_link_tests;
pub mod fault;
pub mod fault_injector;
mod plant;
pub mod tables;

pub use plant::{ActingTorques, DrivenLink, VirtualJoint, VirtualJointState};
pub use tables::{SurroundingsTable, VirtualJointDesign};

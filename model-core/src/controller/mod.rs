//! Controller of one joint (observer and compensation), its trajectories, and the design of its tables.

#[cfg(feature = "design")]
pub mod design;
mod step;
mod tables;
pub mod trajectory;

pub use step::{Answer, Controller};
pub use tables::ControllerDesign;

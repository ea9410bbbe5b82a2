//! Observer and compensation as one controller, the trajectories that it follows, and the design of its tables.

#[cfg(feature = "design")]
pub mod design;
mod step;
pub mod trajectory;

pub use step::{Answer, Controller};

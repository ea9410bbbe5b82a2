//! Observer and compensation as one, and the courses that they are asked to follow.

pub mod course;
#[cfg(feature = "design")]
pub mod design;
mod step;

pub use step::{Answer, Controller};

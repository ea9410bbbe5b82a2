//! The fixed step, in f32 on a board: `model` is the door; `flow` takes ticks in which contacts hold, `substep` and
//! `crossing` those in which they may change; `contact`, `excitation` and `phase` are what both stand on; `peers` is what people use today,
//! for comparison.

#![allow(clippy::needless_range_loop, reason = "one index walks several tables of the same mesh")]

mod contact;
mod crossing;
mod excitation;
mod flow;
mod model;
mod peers;
pub mod phase;
mod runge_kutta;
mod state;
mod substep;

pub use model::{Model, Outputs, Torques};
pub use state::{Relative, RigidBody, State};

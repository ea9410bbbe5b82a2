//! The fixed step, in f32 on a board: `model` is the door; `flow` takes ticks in which contacts hold, `substep` and
//! `crossing` those in which they may change; `mesh_force`, `excitation` and `phase` are what both stand on.

mod crossing;
mod excitation;
mod flow;
mod mesh_force;
mod model;
pub mod phase;
mod state;
mod substep;

pub use model::{Model, Outputs, Torques};
pub use state::{Relative, RigidBody, State};

//! The fixed step, in f32 on a board: `model` is the door; `flow` takes ticks in which contacts hold, `substep` and
//! `crossing` those in which they may change; `pressed` and `light` do the same for planets that ring several times in a
//! tick; `contact`, `excitation` and `phase` are what all stand on; `unfrozen` is the path of the tanh dead zone and
//! what people use today, `paper` the paper's. `virtual_joint` puts a motor around them, `upset` faults. `observer` and `compensation` run beside a motor controller instead.

#![allow(clippy::needless_range_loop, reason = "one index walks several tables of the same mesh")]

mod arithmetic;
pub mod compensation;
mod contact;
pub mod controller;
pub mod course;
mod crossing;
mod excitation;
mod flow;
mod frozen;
mod light;
mod model;
pub mod observer;
mod paper;
pub mod phase;
mod planets;
mod pressed;
mod runge_kutta;
mod sharp;
mod stages;
mod state;
mod substep;
mod unfrozen;
pub mod upset;
pub mod virtual_joint;

pub use model::{Model, Outputs, Torques};
pub use state::{Relative, RigidBody, State};

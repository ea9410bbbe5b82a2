//! The gears: what follows from a joint's parameters, the tables that are designed from them, and the fixed step that
//! moves them, in f32 on a board.
//!
//! `model` is the door; `flow` takes ticks in which contacts hold, `substep` and `crossing` those in which they may
//! change; `pressed` and `light` do the same for planets that ring several times in a tick; `contact`, `excitation` and
//! `stages` are what all stand on; `unfrozen` is the path of the tanh dead zone and what people use today, `paper` the
//! paper's. The laws that parameters leave open stand beside it: [`Kinematics`], [`Mechanics`], [`MeshPhasing`],
//! [`StiffnessSeries`], [`dead_zone`] and [`gear_losses`]; `design` (f64, offline) makes [`tables`] of them.

#![allow(clippy::needless_range_loop, reason = "one index walks several tables of the same mesh")]

pub mod certificate;
mod contact;
mod crossing;
pub mod dead_zone;
#[cfg(feature = "design")]
pub mod design;
mod excitation;
mod flank;
mod flow;
mod frozen;
mod kinematics;
mod light;
mod losses;
mod mechanics;
mod mesh_phases;
mod model;
mod paper;
mod planets;
mod pressed;
mod runge_kutta;
mod scales;
mod sharp;
mod stages;
mod state;
mod stiffness_series;
mod substep;
pub mod tables;
mod unfrozen;

pub use flank::{Flank, contact_state, sign};
pub use kinematics::Kinematics;
pub use losses::gear_losses;
pub use mechanics::Mechanics;
pub use mesh_phases::MeshPhasing;
pub use model::{Model, Outputs, Torques};
pub use scales::Scales;
pub use state::{Relative, RigidBody, State};
pub use stiffness_series::StiffnessSeries;
pub use tables::{Scheme, Tables};

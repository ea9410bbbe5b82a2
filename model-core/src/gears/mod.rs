//! The gears: what follows from a joint's parameters, the tables that are designed from them, and the fixed step that
//! moves them, in f32 on a board.
//!
//! Start with `model`. `flow` takes ticks in which contacts hold, `substep` and `crossing` those in which they may change,
//! and `warm_start` chooses between the two; `linear_contact` and `light` do the same for planets that ring several times in
//! a tick; `contact`, `fixed_contact_set`, `excitation` and `stages` serve all of them; `full_forces` has the path of the
//! tanh dead zone and the common methods, `paper` the paper's. The laws that parameters leave open stand beside it: [`Kinematics`], [`Mechanics`], [`MeshPhasing`],
//! [`StiffnessSeries`], [`dead_zone`] and [`gear_losses`]; `design` (f64, offline) makes [`tables`] of them.

#![allow(clippy::needless_range_loop, reason = "one index walks several tables of the same mesh")]

pub mod certificate;
mod contact;
mod crossing;
pub mod dead_zone;
#[cfg(feature = "design")]
pub mod design;
mod equivalent;
mod excitation;
mod fixed_contact_set;
mod flank;
mod flow;
mod full_forces;
mod kinematics;
mod light;
mod linear_contact;
mod losses;
mod mechanics;
mod mesh_phases;
mod model;
#[cfg(feature = "design")]
mod paper;
mod planets;
mod runge_kutta;
mod scales;
mod stages;
mod state;
mod stiffness_series;
mod substep;
pub mod tables;
mod warm_start;

pub use flank::{Flank, contact_state, sign};
pub use kinematics::Kinematics;
pub use losses::{SELF_LOCKING, gear_losses};
pub use mechanics::Mechanics;
pub use mesh_phases::MeshPhasing;
pub use model::{Model, Outputs, Torques};
pub use scales::Scales;
pub use state::{Relative, RigidBody, State};
pub use stiffness_series::StiffnessSeries;
pub use tables::{Scheme, Tables};

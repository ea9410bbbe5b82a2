//! Gear model: quantities derived from a joint's parameters, the tables designed from these, and the fixed step, which
//! advances the joint on the tables (f32 on a board). Equations (S1) to (S13): docs/theory/step.md.
//!
//! Start with `model`. `warm_start` chooses the path of a tick: `flow` while contacts hold, `substep` and `crossing` while
//! contacts may change. For light planets, which ring several times in a tick, `light` chooses between `linear_contact` and
//! Verlet sub-steps. These paths share `contact`, `fixed_contact_set`, `excitation` and `stages`. `full_forces` holds the
//! step of the tanh dead zone and common methods for comparison, `paper` the paper's method, `equivalent` the step of
//! gears without teeth. [`Kinematics`], [`Mechanics`], [`MeshPhasing`], [`StiffnessSeries`], [`dead_zone`] and
//! [`gear_losses`] derive quantities from parameters; `design` (f64, offline) computes [`tables`].

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

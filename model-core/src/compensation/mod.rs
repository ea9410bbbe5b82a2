//! Backlash compensation: computes the motor torque from the observer's estimates and a set-point, once per control
//! period.
//!
//! The structure, front to back:
//! 1. `position` and `impedance` turn a set-point into an `Intent`: the torque of the control law while a flank
//!    carries, and the torque through the teeth (the demand), now and at the end of a crossing that begins now.
//! 2. `flank` selects the flank that carries the demand and the time to leave for it, by the table in [`transitions`].
//! 3. `crossing` and `path` move the motor through the gap to the place where the link will be, and land it softly on
//!    the flank.
//! 4. `limit` bounds the torque through the teeth. `braking` bounds the link's speed by the motor's braking torque.
//! 5. `load` splits the load torque into an even load and dry friction, which predicts the torque after a reversal.
//!    `load_swing` detects a swinging payload, `start_prediction` predicts the direction of the next start, `easing`
//!    leaves a load at rest to friction.
//! 6. `plain` controls without compensation: a PID on the motor position without a limit of the teeth while the link is
//!    not seen, or the commanded impedance law. `plain` or `inverse` takes over within one control period when the
//!    estimates become invalid; the way back is blended.
//! 7. `inverse` controls the motor until the gap is known, and after `watch` has detected a hunting loop: a PID with an
//!    adaptive inverse of the backlash. `demand` estimates the demand of `inverse` from the torque. `brakes` separates
//!    even load from friction for `demand` and `load`.
//!
//! `docs/theory/compensation.md` derives the equations and states the limits.

mod brakes;
mod braking;
mod crossing;
mod demand;
#[cfg(feature = "design")]
pub mod design;
mod easing;
mod flank;
mod impedance;
mod integral;
mod intent;
mod inverse;
mod limit;
mod load;
mod load_swing;
mod path;
mod plain;
mod position;
mod set_point;
mod situation;
mod start_prediction;
mod step;
mod stream;
mod swing;
pub mod tables;
pub mod transitions;
mod turn;
mod watch;

pub use set_point::{Command, CommandRef, ImpedancePoint, Motion, Position, Shaped, Stage};
pub use step::Compensation;
pub use tables::CompensationTables;

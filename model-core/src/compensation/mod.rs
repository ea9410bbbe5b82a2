//! Backlash compensation: computes the motor torque from the observer's estimates and a set-point, once per control
//! period.
//!
//! The structure, front to back:
//! 1. `position` and `impedance` turn a set-point into a `ControlDemand`: the torque of the control law while a flank
//!    carries, and the torque through the teeth (the demand), now and at the end of a crossing that begins now.
//! 2. `flank` selects the flank that carries the demand and the time to leave for it, by the table in [`transitions`].
//! 3. `crossing_timing` and `crossing_path` move the motor through the gap to the place where the link will be, and
//!    land it softly on the flank.
//! 4. `limit` bounds the torque through the teeth. `braking` bounds the link's speed by the motor's braking torque.
//! 5. `load` splits the load torque into a gravity torque and dry friction, which predicts the torque after a reversal.
//!    `payload_swing` detects a swinging payload, `start_prediction` predicts the direction of the next start, `easing`
//!    leaves a load at rest to friction.
//! 6. `plain` controls without compensation: a PID on the motor position without a limit of the teeth while the link is
//!    not seen, or the commanded impedance law. `plain` or `inverse` takes over within one control period when the
//!    estimates become invalid; the way back is blended.
//! 7. `inverse` controls the motor until the gap is known, and after `monitor` has detected a hunting loop: a PID with
//!    an adaptive inverse of the backlash. `demand_estimator` estimates the demand of `inverse` from the torque.
//!    `load_friction` separates gravity torque from friction for `demand_estimator` and `load`.
//!
//! `docs/theory/compensation.md` derives the equations and states the limits.

mod braking;
mod control_demand;
mod crossing_path;
mod crossing_timing;
mod demand_estimator;
#[cfg(feature = "design")]
pub mod design;
mod easing;
mod flank;
mod impedance;
mod integral;
mod inverse;
mod limit;
mod load;
mod load_friction;
mod loop_state;
mod monitor;
mod payload_swing;
mod plain;
mod position;
mod set_point;
mod set_point_stream;
mod slow_task;
mod start_prediction;
mod step;
pub mod tables;
#[cfg(test)]
mod test_bench;
pub(super) mod thresholds;
mod torque_swing;
pub mod transitions;

pub use set_point::{Command, CommandRef, ControlOutput, ImpedancePoint, Motion, Position, Stage};
pub use step::Compensation;
pub use tables::CompensationTables;

//! Takes the lost motion out: from estimates and a set-point to a motor torque, once a control period.
//!
//! The structure, front to back:
//! 1. `position` and `impedance` turn a set-point into an `Intent`: the torque that the control law
//!    gives while a flank carries, and the torque that the teeth will have to pass on, now and one crossing later.
//! 2. `flank` decides from that which flank shall carry, and when to leave for it, by the table in [`transitions`].
//! 3. `crossing` and `path` take the motor through the gap to where the load will be, and softly onto the flank.
//! 4. `limit` keeps what the teeth pass on within bounds, `braking` the link's speed within what the motor can brake.
//! 5. `load` knows what brakes the link and how that changes when the motion turns round, `load_swing` whether it is a payload that
//!    swings, `start_prediction` how
//!    motions start, `easing` what friction holds at rest.
//! 6. `plain` is control without compensation of a link that is not seen: a PID on the motor's place with part of the feed-forward and no
//!    limit of the teeth; or the commanded impedance law. Where the estimates are not valid it or `inverse` takes over in one control
//!    period; only the way back is blended.
//! 7. `inverse` controls the motor alone until the gap is known, and where `watch` notices a loop that hunts: with an inverse of the
//!    backlash that it learns itself, for the `demand` that it learns from the torque. `brakes` tells weight from friction, for `load` as well.
//!
//! `docs/theory/compensation.md` derives all of it and says where its limits are.

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

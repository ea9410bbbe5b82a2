//! Where the gap is: from encoder counts and motor torque to gap coordinate, contact, torques and everything about the
//! joint that they depend on, once a control period. Making use of it is left to `compensation`.
//!
//! The structure, front to back:
//! 1. `counts` unwraps raw counts and forms motor less ratio times output in whole numbers: exact over any number of
//!    turns and over wrap-around. `places` knows what the encoders' and the gears' errors are there.
//! 2. `drive_side`, a disturbance observer on the motor, gives the mesh force; `load_side`, the same on the link,
//!    position, speed and load torque. Both are linear flows from tables.
//! 3. `motion` tells crossing from rest without knowing the width; `bias` takes from open gaps what the motor's torque is
//!    wrong by; `contact` decides which flank touches.
//! 4. `learner` is one small recursive least squares, updated every few periods in settled contact, for half-backlash,
//!    offset, compliance, skew and the encoders' error maps. `anchor` and `ride` tell flanks without a force that stands
//!    out, and `doubt` what no longer belongs to what was learnt. `parts` gives each period some of that work.
//! 5. `pace` and `supervisor` watch the output encoder and fall back to the motor alone.
//!
//! `docs/observer.md` derives all of it and says what it cannot know.

mod anchor;
mod bias;
mod block;
mod contact;
mod counts;
#[cfg(feature = "design")]
pub mod design;
mod doubt;
mod drive_side;
mod estimates;
mod firm;
mod follow;
mod inertia;
mod interval;
mod knowledge;
mod late;
mod learner;
mod learning;
mod load_side;
mod memory;
mod motion;
mod motor_only;
mod now;
mod pace;
mod parts;
mod places;
mod present;
mod probe;
mod regressors;
mod ride;
mod samples;
mod saying;
mod state;
mod step;
mod supervisor;
pub mod tables;

pub use estimates::{Doubt, Estimate, Estimates, Notices, Shaft, Source};
pub use memory::{MEMORY_BYTES, Memory, MemoryError, memory_numbers};
pub use probe::{Probe, Progress, Refusal};
pub use regressors::{MAPPED, PLAIN};
pub use samples::{Reading, Samples};
pub use state::Observer;
pub use tables::{ObserverTables, ProbeTable};

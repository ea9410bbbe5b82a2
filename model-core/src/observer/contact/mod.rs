//! Contact detection for a controller: by the mesh force alone, by force and deflection (O8, O10), or, without an
//! output encoder, by `health::link_without_encoder`. `identification::flank` decides separately on which flank a rest is used for
//! estimation.

pub mod force_contact;
pub mod gap_position;

mod thresholds;

use force_contact::ForceContact;
use gap_position::GapPosition;

use crate::gears::Flank;
use crate::numbers::Real;

/// Reported contact and its state from period to period.
#[derive(Debug, Clone, Copy, Default)]
pub struct Contact {
    /// Contact by force alone.
    pub by_force: ForceContact,
    /// Flank reported as touching.
    pub reported: Option<Flank>,
    /// True once the teeth have settled after crossing the gap.
    settled: bool,
}

impl Contact {
    /// Updates the reported contact by force and deflection and returns the mesh force of both sensors [N].
    /// `deviations` are the standard deviations of the motor side's force and of the combined force [N]; `settled`
    /// states that the last learning interval was in settled contact.
    #[inline]
    pub fn step_by_position<T: Real>(
        &mut self,
        position: &GapPosition<T>,
        force: T,
        deviations: [T; 2],
        settled: bool,
    ) -> T {
        self.settled = settled || self.settled && position.deflection.abs() > T::HALF * position.half_gap;
        let (reported, force) = position.reported_contact(self.reported, force, deviations, self.settled);
        self.reported = reported;
        force
    }
}

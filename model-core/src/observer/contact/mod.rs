//! Contact detection for a controller: by the mesh force alone, by force and deflection (O8, O10), or, without an
//! output encoder, by `health::link_without_encoder`. `identification::flank` decides separately on which flank a rest
//! is used for estimation.

pub mod force_contact;
pub mod gap_position;

pub(super) mod thresholds;

use force_contact::ForceContact;
use gap_position::GapPosition;

use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

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
state_words! { struct Contact { by_force, reported, settled } }

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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(deflection: f32) -> GapPosition<f32> {
        GapPosition { deflection, travel: 0.0, half_gap: 80.0, blur: 10.0, near: 4.0, stiffness: 5.0, weight: 0.0 }
    }

    #[test]
    fn settled_contact_lasts_until_middle_of_gap() {
        let mut contact = Contact::default();
        contact.step_by_position(&at(75.0), 0.0, [1.0; 2], true);
        contact.step_by_position(&at(41.0), 0.0, [1.0; 2], false);
        contact.step_by_position(&at(75.0), 0.0, [1.0; 2], false);
        assert_eq!(contact.reported, Some(Flank::Drive), "5 of 10 within the blur");
        contact.step_by_position(&at(40.0), 0.0, [1.0; 2], false);
        contact.step_by_position(&at(75.0), 0.0, [1.0; 2], false);
        assert_eq!(contact.reported, None, "teeth that crossed the middle must come nearer");
    }
}

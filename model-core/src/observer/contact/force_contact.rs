//! Contact detection by the mesh force F alone, of standard deviation s. Needs no half-gap and is therefore available
//! first.
//!
//! ```text
//! contact begins:  |F| > 2 s,  for `persistence` control periods
//! contact ends:    |F| < s,    for `persistence` control periods
//! ```

use super::thresholds::CONTACT;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Contact by force alone.
#[derive(Debug, Clone, Copy, Default)]
pub struct ForceContact {
    /// Flank in contact.
    pub flank: Option<Flank>,
    candidate: Option<Flank>,
    candidate_periods: u8,
}
state_words! { struct ForceContact { flank, candidate, candidate_periods } }

impl ForceContact {
    /// Updates the contact. A contact begins above two `deviation`s, the standard deviation of the force [N], and is
    /// kept above one.
    pub fn step<T: Real>(&mut self, force: T, deviation: T) -> Option<Flank> {
        let candidate = with_hysteresis(self.flank, force, T::TWO * deviation, deviation);
        if candidate != self.flank {
            self.candidate_periods = if candidate == self.candidate { self.candidate_periods + 1 } else { 1 };
            if self.candidate_periods >= CONTACT.persistence {
                self.flank = candidate;
            }
        }
        self.candidate = candidate;
        self.flank
    }
}

/// Returns the flank that a force presses: a contact begins above `on` and is kept above `off` [N].
pub fn with_hysteresis<T: Real>(before: Option<Flank>, force: T, on: T, off: T) -> Option<Flank> {
    let flank = if force > T::ZERO { Flank::Drive } else { Flank::Back };
    let threshold = if before == Some(flank) { off } else { on };
    (force.abs() > threshold).then_some(flank)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contact after `periods` of a force, with a standard deviation of 1 N.
    fn after(contact: &mut ForceContact, force: f32, periods: u8) -> Option<Flank> {
        (0..periods).fold(None, |_, _| contact.step(force, 1.0))
    }

    #[test]
    fn contact_begins_above_two_deviations() {
        assert_eq!(with_hysteresis(None, 2.0, 2.0, 1.0), None);
        assert_eq!(with_hysteresis(None, 2.01, 2.0, 1.0), Some(Flank::Drive));
        assert_eq!(with_hysteresis(None, -2.01, 2.0, 1.0), Some(Flank::Back));
    }

    #[test]
    fn contact_is_kept_above_one_deviation() {
        assert_eq!(with_hysteresis(Some(Flank::Drive), 1.01, 2.0, 1.0), Some(Flank::Drive));
        assert_eq!(with_hysteresis(Some(Flank::Drive), 1.0, 2.0, 1.0), None);
    }

    #[test]
    fn other_flank_needs_force_to_begin() {
        assert_eq!(with_hysteresis(Some(Flank::Drive), -1.5, 2.0, 1.0), None);
        assert_eq!(with_hysteresis(Some(Flank::Drive), -2.5, 2.0, 1.0), Some(Flank::Back));
    }

    #[test]
    fn force_of_nan_is_no_contact() {
        assert_eq!(with_hysteresis(Some(Flank::Back), f32::NAN, 2.0, 1.0), None);
        assert_eq!(with_hysteresis(None, f32::INFINITY, 2.0, 1.0), Some(Flank::Drive));
    }

    #[test]
    fn change_needs_persistence() {
        let mut contact = ForceContact::default();
        assert_eq!(after(&mut contact, 5.0, CONTACT.persistence - 1), None);
        assert_eq!(after(&mut contact, 5.0, 1), Some(Flank::Drive));
    }

    #[test]
    fn interrupted_change_starts_anew() {
        let mut contact = ForceContact::default();
        after(&mut contact, 5.0, CONTACT.persistence - 1);
        after(&mut contact, 0.0, 1);
        assert_eq!(after(&mut contact, 5.0, CONTACT.persistence - 1), None);
        assert_eq!(after(&mut contact, 5.0, 1), Some(Flank::Drive));
    }

    #[test]
    fn alternating_force_keeps_contact_open() {
        let mut contact = ForceContact::default();
        for period in 0..20 {
            assert_eq!(contact.step(if period % 2 == 0 { 5.0 } else { -5.0 }, 1.0), None);
        }
    }
}

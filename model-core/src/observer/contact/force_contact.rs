//! Contact detection by the mesh force alone, with hysteresis and persistence. Needs no half-gap and is therefore
//! available first.

use super::thresholds::CONTACT;
use crate::gears::Flank;
use crate::numbers::Real;

/// Contact by force alone.
#[derive(Debug, Clone, Copy, Default)]
pub struct ForceContact {
    /// Flank in contact.
    pub flank: Option<Flank>,
    candidate: Option<Flank>,
    candidate_periods: u8,
}

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

//! Contact by the mesh force alone, with hysteresis and persistence: it needs no half-gap, so it is what there is first.

use crate::gears::Flank;
use crate::numbers::Real;

/// Control periods for which the force must say the same before contact by force follows it: noise of one period, and
/// of the next that the filter carries it into, makes no contact.
const PERSISTENCE: u8 = 3;

/// Contact by force alone.
#[derive(Debug, Clone, Copy, Default)]
pub struct ByForce {
    /// The flank that touches.
    pub flank: Option<Flank>,
    wanted: Option<Flank>,
    held: u8,
}

impl ByForce {
    /// `deviation` is the standard deviation of the force [N]; it takes two of it to make contact and one to keep it.
    pub fn step<T: Real>(&mut self, force: T, deviation: T) -> Option<Flank> {
        let wanted = with_hysteresis(self.flank, force, T::TWO * deviation, deviation);
        if wanted != self.flank {
            self.held = if wanted == self.wanted { self.held + 1 } else { 1 };
            if self.held >= PERSISTENCE {
                self.flank = wanted;
            }
        }
        self.wanted = wanted;
        self.flank
    }
}

/// The flank that a force presses: a contact is made by more than `on` and kept by more than `off` [N].
pub fn with_hysteresis<T: Real>(before: Option<Flank>, force: T, on: T, off: T) -> Option<Flank> {
    let flank = if force > T::ZERO { Flank::Drive } else { Flank::Back };
    let least = if before == Some(flank) { off } else { on };
    (force.abs() > least).then_some(flank)
}

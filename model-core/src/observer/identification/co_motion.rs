//! Detection of contact without force: with open teeth, motor and link move together only if the load happens to move
//! the link as the motor moves. The farther the link departs from a motion at constant speed, the less likely this
//! coincidence is.

use crate::gears::Flank;
use crate::numbers::Real;

/// Departure of the link from constant speed that proves contact [spans]. With open teeth the load would have
/// reproduced the motor's motion to one part in 64, as the deflection may change by an eighth of the gap meanwhile.
const MIN_DEPARTURE: i32 = 8;

/// Rest in which motor and link move together.
#[derive(Debug, Clone, Copy)]
pub struct CoMotion<T: Real> {
    /// Change of the deflection from the rest on the other flank to the beginning of this rest, upwards positive; 0 if
    /// unknown [m].
    span: T,
    /// Change of the deflection since the beginning of this rest, upwards positive [m].
    drift: T,
    /// Travel of the link per block at the beginning of this rest [m].
    initial_travel: T,
    /// Travel of the link since then in excess of a motion at that speed [m].
    link_departure: T,
}

/// Relation of a rest to the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeflectionChange {
    /// The flank has changed: the deflection moved too far for one flank.
    Crossed,
    /// Neither a crossing nor the same flank is certain.
    Unsure,
    /// The deflection fits the same flank, but noise could hide a crossing.
    Hidden,
    /// The flank is unchanged.
    Stays,
}

impl<T: Real> CoMotion<T> {
    pub const NONE: Self = Self { span: T::ZERO, drift: T::ZERO, initial_travel: T::ZERO, link_departure: T::ZERO };

    /// Smallest half-gap proven by a crossing, over the observed span [-]: a crossing needs four standard deviations,
    /// so that one deviation is at most a quarter of the span. The remainder is two half-gaps of 3/8 each.
    const PROVEN_SHARE: T = T::THREE_EIGHTHS;

    /// Largest change of the deflection during a rest on one flank, over the gap [-].
    const MAX_DRIFT: T = T::EIGHTH;

    /// Updates the state with a block: its relation to the last block, the change of the deflection, the travel of the
    /// link, and `is_continuous` if the rest was not interrupted. Without `link_moves` the travel is not counted: friction may
    /// hold the link.
    pub fn step(
        &mut self,
        change: DeflectionChange,
        change_of_deflection: T,
        link_travel: T,
        is_continuous: bool,
        link_moves: bool,
    ) {
        self.drift += change_of_deflection;
        match change {
            DeflectionChange::Crossed => (self.span, self.drift) = (change_of_deflection, T::ZERO),
            DeflectionChange::Hidden => self.span = T::ZERO,
            DeflectionChange::Unsure | DeflectionChange::Stays => {}
        }
        if !is_continuous || matches!(change, DeflectionChange::Crossed | DeflectionChange::Unsure) {
            (self.initial_travel, self.link_departure) = (link_travel, T::ZERO);
        } else if link_moves {
            self.link_departure += link_travel - self.initial_travel;
        }
    }

    /// Estimated half-gap, or the half-gap proven by a crossing if larger.
    pub fn half_gap_at_least(&self, estimate: T) -> T {
        let proven = Self::PROVEN_SHARE * self.span.abs();
        if proven > estimate { proven } else { estimate }
    }

    /// Takes the flank of this rest from the force.
    pub fn confirm_flank(&mut self, flank: Flank) {
        if flank.sign::<T>() * self.span < T::ZERO {
            self.span = T::ZERO;
        }
        (self.drift, self.link_departure) = (T::ZERO, T::ZERO);
    }

    /// Returns true if the link has departed by `MIN_DEPARTURE` gaps: the teeth touch, on either flank.
    pub fn proves_contact(&self, half_gap: T) -> bool {
        self.link_departure.abs() > T::from_i32(MIN_DEPARTURE) * T::TWO * half_gap
    }

    /// Flank of this rest, if the link has departed by `MIN_DEPARTURE` spans since the crossing.
    pub fn flank(&self) -> Option<Flank> {
        let span = self.span.abs();
        let has_departed = self.link_departure.abs() > T::from_i32(MIN_DEPARTURE) * span;
        if !has_departed || self.drift.abs() >= span * Self::MAX_DRIFT {
            return None;
        }
        Some(if self.span > T::ZERO { Flank::Drive } else { Flank::Back })
    }
}

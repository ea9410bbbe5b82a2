//! Detection of contact without force: with open teeth, motor and link move together only if the load happens to move
//! the link as the motor moves. The farther the link departs from a motion at constant speed, the less likely this
//! coincidence is.

use crate::gears::Flank;
use crate::numbers::Real;

/// Departure of the link from constant speed that proves contact [spans]. With open teeth the load would have
/// reproduced the motor's motion to one part in 64, as the deflection may change by an eighth of the gap meanwhile.
const ASTRAY: i32 = 8;

/// Rest in which motor and link move together.
#[derive(Debug, Clone, Copy)]
pub struct CoMotion<T: Real> {
    /// Change of the deflection from the rest on the other flank to the beginning of this rest, upwards positive; 0 if
    /// unknown [m].
    span: T,
    /// Change of the deflection since the beginning of this rest, upwards positive [m].
    drifted: T,
    /// Travel of the link per block at the beginning of this rest [m].
    began: T,
    /// Travel of the link since then in excess of a motion at that speed [m].
    strayed: T,
}

/// Relation of a rest to the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
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
    pub const NONE: Self = Self { span: T::ZERO, drifted: T::ZERO, began: T::ZERO, strayed: T::ZERO };

    /// Smallest half-gap proven by a crossing, over the observed span [-]: a crossing needs four standard deviations,
    /// so that one deviation is at most a quarter of the span. The remainder is two half-gaps of 3/8 each.
    const CERTAIN: T = T::THREE_EIGHTHS;

    /// Largest change of the deflection during a rest on one flank, over the gap [-].
    const DRIFT: T = T::EIGHTH;

    /// Updates the state with a block: its relation to the last block, the change of the deflection, the travel of the
    /// link, and `goes_on` if the rest was not interrupted. Without `moves` the travel is not counted: friction may
    /// hold the link.
    pub fn step(&mut self, change: Change, moved: T, went: T, goes_on: bool, moves: bool) {
        self.drifted += moved;
        match change {
            Change::Crossed => (self.span, self.drifted) = (moved, T::ZERO),
            Change::Hidden => self.span = T::ZERO,
            Change::Unsure | Change::Stays => {}
        }
        if !goes_on || matches!(change, Change::Crossed | Change::Unsure) {
            (self.began, self.strayed) = (went, T::ZERO);
        } else if moves {
            self.strayed += went - self.began;
        }
    }

    /// Estimated half-gap, or the half-gap proven by a crossing if larger.
    pub fn half_gap_at_least(&self, learnt: T) -> T {
        let seen = Self::CERTAIN * self.span.abs();
        if seen > learnt { seen } else { learnt }
    }

    /// Takes the flank of this rest from the force.
    pub fn told(&mut self, flank: Flank) {
        if flank.sign::<T>() * self.span < T::ZERO {
            self.span = T::ZERO;
        }
        (self.drifted, self.strayed) = (T::ZERO, T::ZERO);
    }

    /// Returns true if the link has departed by `ASTRAY` gaps: the teeth touch, on either flank.
    pub fn lasts(&self, half_gap: T) -> bool {
        self.strayed.abs() > T::from_i32(ASTRAY) * T::TWO * half_gap
    }

    /// Flank of this rest, if the link has departed by `ASTRAY` spans since the crossing.
    pub fn flank(&self) -> Option<Flank> {
        let span = self.span.abs();
        let astray = self.strayed.abs() > T::from_i32(ASTRAY) * span;
        if !astray || self.drifted.abs() >= span * Self::DRIFT {
            return None;
        }
        Some(if self.span > T::ZERO { Flank::Drive } else { Flank::Back })
    }
}

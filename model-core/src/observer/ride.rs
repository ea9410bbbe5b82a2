//! Whether teeth at rest are on a flank, without any force: motor and link stay together with open teeth only if the load
//! happens to move the link just as the motor goes. How far the link has gone from where it would be at the speed that
//! it had says how much of a chance that would be. When they are at rest is left to `motion`, and which flank it is to
//! `anchor`.

use super::motion::magnitude;
use crate::numbers::Real;

/// Gaps by which a link must have gone astray for its teeth to be on a flank: with open teeth the load would have moved it
/// as the motor goes to within one part in 64, for in all that time the way may change by an eighth of the gap.
const ASTRAY: i32 = 8;

/// One rest, or what is known of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ride<T: Real> {
    /// Way from the rest on the other side to the beginning of this one, upwards positive; 0 where that is not known [m].
    span: T,
    /// How far the way has gone since, upwards positive [m].
    drifted: T,
    /// What the link went in a block when it began [m].
    began: T,
    /// How much further it has gone since than it would have at that speed [m].
    strayed: T,
}

/// How a rest follows the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    /// Too far for the same flank.
    Crossed,
    /// Neither for sure.
    Unsure,
    /// As far as the same flank allows, but a crossing would not be seen.
    Hidden,
    /// On the same flank.
    Stays,
}

impl<T: Real> Ride<T> {
    pub const NONE: Self = Self { span: T::ZERO, drifted: T::ZERO, began: T::ZERO, strayed: T::ZERO };

    /// Takes in a block: how its way follows the one before and by how much, what the link went in it, and whether there
    /// was nothing but rest since. While the link hardly moves, friction may hold it.
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

    /// The half-gap as it is said, or what the teeth were seen to cross if that is more: a gap is no narrower. A quarter is
    /// left for what the crossing may have been wrong by, at four standard deviations.
    pub fn half_gap_at_least(&self, said: T) -> T {
        let seen = (T::QUARTER + T::EIGHTH) * magnitude(self.span);
        if seen > said { seen } else { said }
    }

    /// The force has told on which side this rest is.
    pub fn told(&mut self, side: T) {
        if side * self.span < T::ZERO {
            self.span = T::ZERO;
        }
        (self.drifted, self.strayed) = (T::ZERO, T::ZERO);
    }

    /// Whether the link has gone that far while the width was not known: it was on a flank, whichever it is.
    pub fn lasts(&self, half_gap: T) -> bool {
        magnitude(self.strayed) > T::from_i32(ASTRAY) * T::TWO * half_gap
    }

    /// The side, if it has gone that far since the teeth came across the gap; else 0.
    pub fn side(&self) -> T {
        let span = magnitude(self.span);
        let astray = magnitude(self.strayed) > T::from_i32(ASTRAY) * span;
        if !astray || magnitude(self.drifted) >= span * T::EIGHTH {
            T::ZERO
        } else if self.span > T::ZERO {
            T::ONE
        } else {
            -T::ONE
        }
    }
}

//! Whether teeth at rest are on a flank, without any force: motor and link stay together with open teeth only if the load
//! happens to move the link just as the motor goes. How far the link has gone from where it would be at the speed that
//! it had says how much of a chance that would be.

use crate::gears::Flank;
use crate::numbers::Real;

/// Spans by which a link must have left its course for its teeth to be on a flank: with open teeth the load would have
/// moved it as the motor goes to within one part in 64, for in all that time the deflection may change by an eighth of
/// the gap.
const ASTRAY: i32 = 8;

/// One rest in which motor and link move together.
#[derive(Debug, Clone, Copy)]
pub struct CoMotion<T: Real> {
    /// Deflection from the rest on the other flank to the beginning of this one, upwards positive; 0 where that is not
    /// known [m].
    span: T,
    /// How far the deflection has gone since, upwards positive [m].
    drifted: T,
    /// What the link went in a block when it began [m].
    began: T,
    /// How much further it has gone since than it would have at that speed [m].
    strayed: T,
}

/// How a rest follows the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Too far for the same flank.
    Crossed,
    /// Neither for sure.
    Unsure,
    /// As far as the same flank allows, but a crossing would not be seen.
    Hidden,
    /// On the same flank.
    Stays,
}

impl<T: Real> CoMotion<T> {
    pub const NONE: Self = Self { span: T::ZERO, drifted: T::ZERO, began: T::ZERO, strayed: T::ZERO };

    /// Smallest half-gap that a crossing proves, over the span that was seen [-]: a crossing is told by four standard
    /// deviations, so one of them is a quarter of the span at most. What is left is two half-gaps: 3/8 each.
    const CERTAIN: T = T::THREE_EIGHTHS;

    /// Part of the gap by which the deflection may change in a rest on one flank [-].
    const DRIFT: T = T::EIGHTH;

    /// Takes in a block: how its deflection follows the one before and by how much, what the link went in it, and whether
    /// there was nothing but rest since. While the link hardly moves, friction may hold it.
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

    /// The half-gap as it was learnt, or what the teeth were seen to cross if that is more: a gap is no narrower.
    pub fn half_gap_at_least(&self, learnt: T) -> T {
        let seen = Self::CERTAIN * self.span.abs();
        if seen > learnt { seen } else { learnt }
    }

    /// The force has told on which flank this rest is.
    pub fn told(&mut self, flank: Flank) {
        if flank.sign::<T>() * self.span < T::ZERO {
            self.span = T::ZERO;
        }
        (self.drifted, self.strayed) = (T::ZERO, T::ZERO);
    }

    /// Whether the link has gone that far while the half-gap was not known: it was on a flank, whichever it is.
    pub fn lasts(&self, half_gap: T) -> bool {
        self.strayed.abs() > T::from_i32(ASTRAY) * T::TWO * half_gap
    }

    /// The flank, if the link has gone that far since the teeth came across the gap.
    pub fn flank(&self) -> Option<Flank> {
        let span = self.span.abs();
        let astray = self.strayed.abs() > T::from_i32(ASTRAY) * span;
        if !astray || self.drifted.abs() >= span * Self::DRIFT {
            return None;
        }
        Some(if self.span > T::ZERO { Flank::Drive } else { Flank::Back })
    }
}

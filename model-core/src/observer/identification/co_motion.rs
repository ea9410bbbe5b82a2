//! Detection of contact without force: with open teeth, motor and link move together only if the load happens to move
//! the link as the motor moves. The farther the link departs from a motion at constant speed, the less likely this
//! coincidence is.

use super::thresholds::CoMotionThresholds;
use crate::gears::Flank;
use crate::numbers::Real;

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
    const LIMITS: CoMotionThresholds<T> = CoMotionThresholds::TUNED;

    pub const NONE: Self = Self { span: T::ZERO, drift: T::ZERO, initial_travel: T::ZERO, link_departure: T::ZERO };

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
        let proven = Self::LIMITS.proven_share * self.span.abs();
        if proven > estimate { proven } else { estimate }
    }

    /// Takes the flank of this rest from the force.
    pub fn confirm_flank(&mut self, flank: Flank) {
        if flank.sign::<T>() * self.span < T::ZERO {
            self.span = T::ZERO;
        }
        (self.drift, self.link_departure) = (T::ZERO, T::ZERO);
    }

    /// Returns true if the link has departed by `Self::LIMITS.departure` gaps: the teeth touch, on either flank.
    pub fn proves_contact(&self, half_gap: T) -> bool {
        self.link_departure.abs() > T::from_i32(Self::LIMITS.departure) * T::TWO * half_gap
    }

    /// Flank of this rest, if the link has departed by `Self::LIMITS.departure` spans since the crossing.
    pub fn flank(&self) -> Option<Flank> {
        let span = self.span.abs();
        let has_departed = self.link_departure.abs() > T::from_i32(Self::LIMITS.departure) * span;
        if !has_departed || self.drift.abs() >= span * Self::LIMITS.max_drift {
            return None;
        }
        Some(if self.span > T::ZERO { Flank::Drive } else { Flank::Back })
    }
}

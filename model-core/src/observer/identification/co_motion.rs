//! Detection of contact without force: with open teeth, motor and link move together only if the load happens to move
//! the link as the motor moves. The farther the link departs from a motion at constant speed, the less likely this
//! coincidence is.

use super::thresholds::CoMotionThresholds;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Rest in which motor and link move together.
#[derive(Debug, Clone, Copy)]
pub struct CoMotion<T: Real> {
    /// Change of the deflection from the dwell on the other flank to the beginning of this dwell, upwards positive; 0
    /// if unknown [m].
    span: T,
    /// Change of the deflection since the beginning of this dwell, upwards positive [m].
    drift: T,
    /// Travel of the link per batch at the beginning of this dwell [m].
    initial_travel: T,
    /// Travel of the link since then in excess of a motion at that speed [m].
    link_departure: T,
}
state_words! { struct CoMotion<T> { span, drift, initial_travel, link_departure } }

/// Relation of a dwell to the last one.
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

    /// Updates the state with a batch: its relation to the last batch, the change of the deflection, the travel of the
    /// link, and `is_continuous` if the dwell was not interrupted. Without `link_moves` the travel is not counted:
    /// friction may hold the link.
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

    /// Takes the flank of this dwell from the force.
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

    /// Flank of this dwell, if the link has departed by `Self::LIMITS.departure` spans since the crossing.
    pub fn flank(&self) -> Option<Flank> {
        let span = self.span.abs();
        let has_departed = self.link_departure.abs() > T::from_i32(Self::LIMITS.departure) * span;
        if !has_departed || self.drift.abs() >= span * Self::LIMITS.max_drift {
            return None;
        }
        Some(if self.span > T::ZERO { Flank::Drive } else { Flank::Back })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Co-motion after a crossing by a span, and `batches` in which the link accelerates by a unit of travel each.
    fn crossed(span: f32, blocks: u8) -> CoMotion<f32> {
        let mut co_motion = CoMotion::NONE;
        co_motion.step(DeflectionChange::Crossed, span, 0.0, true, true);
        for _ in 0..blocks {
            co_motion.step(DeflectionChange::Stays, 0.0, 1.0, true, true);
        }
        co_motion
    }

    #[test]
    fn crossing_proves_part_of_half_gap() {
        assert_eq!(crossed(80.0, 0).half_gap_at_least(20.0), 30.0);
        assert_eq!(crossed(-80.0, 0).half_gap_at_least(40.0), 40.0);
    }

    #[test]
    fn departure_beyond_limit_shows_flank() {
        assert_eq!(crossed(1.0, 8).flank(), None);
        assert_eq!(crossed(1.0, 9).flank(), Some(Flank::Drive));
        assert_eq!(crossed(-1.0, 9).flank(), Some(Flank::Back));
    }

    #[test]
    fn drift_hides_flank() {
        let mut co_motion = crossed(1.0, 9);
        co_motion.step(DeflectionChange::Stays, 0.124, 1.0, true, true);
        assert_eq!(co_motion.flank(), Some(Flank::Drive));
        co_motion.step(DeflectionChange::Stays, 0.002, 1.0, true, true);
        assert_eq!(co_motion.flank(), None);
    }

    #[test]
    fn hidden_crossing_clears_span() {
        let mut co_motion = crossed(1.0, 9);
        co_motion.step(DeflectionChange::Hidden, 0.0, 1.0, true, true);
        assert_eq!(co_motion.half_gap_at_least(0.1), 0.1);
    }

    #[test]
    fn interruption_restarts_departure() {
        let mut co_motion = crossed(1.0, 9);
        co_motion.step(DeflectionChange::Stays, 0.0, 5.0, false, true);
        assert_eq!(co_motion.flank(), None);
        co_motion.step(DeflectionChange::Stays, 0.0, 14.0, true, true);
        assert_eq!(co_motion.flank(), Some(Flank::Drive), "9 beyond the new initial travel");
    }

    #[test]
    fn stationary_link_does_not_depart() {
        let mut co_motion = crossed(1.0, 0);
        (0..20).for_each(|_| co_motion.step(DeflectionChange::Stays, 0.0, 1.0, true, false));
        assert_eq!(co_motion.flank(), None);
    }

    #[test]
    fn opposite_force_clears_span() {
        let mut co_motion = crossed(80.0, 0);
        co_motion.confirm_flank(Flank::Drive);
        assert_eq!(co_motion.half_gap_at_least(0.0), 30.0);
        co_motion.confirm_flank(Flank::Back);
        assert_eq!(co_motion.half_gap_at_least(0.0), 0.0);
    }

    #[test]
    fn departure_of_eight_gaps_proves_contact() {
        assert!(!crossed(1.0, 16).proves_contact(1.0));
        assert!(crossed(1.0, 17).proves_contact(1.0));
    }
}

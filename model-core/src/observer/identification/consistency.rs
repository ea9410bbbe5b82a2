//! Consistency of dwells with the estimated parameters: a dwell is accepted or rejected; repeated rejections reset the
//! half-gap, as teeth wear, and finally all parameters.

use super::thresholds::CONSISTENCY;
use crate::gears::Flank;
use crate::numbers::state_words::state_words;

/// Evidence against the estimated parameters.
#[derive(Debug, Clone, Copy, Default)]
pub struct Consistency {
    /// Consecutive intervals in which teeth transmit force between the estimated flanks.
    gap_force_intervals: u8,
    /// Consecutive outliers.
    outliers: u8,
    /// Accepted dwells on the back flank and on the drive flank since the half-gap was last in doubt.
    accepted: [u8; 2],
    /// Recent errors that were attributed to the variation of the half-gap around the turn.
    variation_errors: u8,
    /// Accepted dwells since the last of these errors.
    accepted_since_error: u8,
}
state_words! {
    struct Consistency {
        gap_force_intervals, outliers, accepted, variation_errors, accepted_since_error,
    }
}

/// Deviation of a dwell, or of a force between the flanks, from the estimated parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviationSize {
    /// Less than the tolerance of a known half-gap.
    WithinTolerance,
    /// Within the variation of a half-gap around the turn.
    WithinVariation,
    /// More than this variation.
    BeyondVariation,
}

/// Consequence for the estimated parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterAction {
    /// No change.
    Keep,
    /// The variance of the half-gap grows: the half-gap may differ at this place of the turn, as in worn gears.
    InflateHalfGap,
    /// The variance of the half-gap is reset; its value is kept.
    ResetHalfGap,
    /// The variances of all parameters are reset.
    ResetAll,
    /// The output encoder fails: the gap seems narrower than the half-gap trusted on both flanks, or no parameter
    /// agrees any more. Teeth do not grow, and shafts do not turn against each other.
    OutputEncoderFault,
}

impl Consistency {
    /// Judges an interval: force at rest between the flanks, beyond bias and stiction, contradicts the estimated flanks
    /// by `DeviationSize`.
    pub fn check_gap_force(&mut self, force_between_flanks: Option<DeviationSize>) -> ParameterAction {
        self.gap_force_intervals = if force_between_flanks.is_some() { self.gap_force_intervals + 1 } else { 0 };
        let Some(deviation) =
            force_between_flanks.filter(|_| self.gap_force_intervals >= CONSISTENCY.gap_force_intervals)
        else {
            return ParameterAction::Keep;
        };
        self.gap_force_intervals = 0;
        // The gap is narrower than estimated.
        if !self.is_trusted() {
            return self.discard_half_gap();
        }
        if deviation != DeviationSize::BeyondVariation && self.attribute_to_variation() {
            ParameterAction::InflateHalfGap
        } else {
            ParameterAction::OutputEncoderFault
        }
    }

    /// Returns true if the error may once more be attributed to the variation around the turn.
    fn attribute_to_variation(&mut self) -> bool {
        self.accepted_since_error = 0;
        let is_attributed = self.variation_errors < CONSISTENCY.variation_errors;
        self.variation_errors = self.variation_errors.saturating_add(1);
        is_attributed
    }

    /// Judges an outlier by its deviation; `was_trusted` is true once a half-gap was trusted.
    pub fn reject(&mut self, deviation: DeviationSize, was_trusted: bool) -> ParameterAction {
        self.outliers += 1;
        if self.outliers >= CONSISTENCY.outliers_until_all {
            self.outliers = 0;
            if was_trusted { ParameterAction::OutputEncoderFault } else { ParameterAction::ResetAll }
        } else if self.outliers != CONSISTENCY.outliers_until_half_gap || deviation == DeviationSize::WithinTolerance {
            ParameterAction::Keep
        } else if deviation == DeviationSize::WithinVariation && self.is_trusted() && self.attribute_to_variation() {
            ParameterAction::InflateHalfGap
        } else {
            self.discard_half_gap()
        }
    }

    /// Counts an accepted dwell.
    pub fn accept(&mut self, flank: Option<Flank>) {
        self.outliers = 0;
        self.accepted_since_error = self.accepted_since_error.saturating_add(1);
        if self.accepted_since_error >= CONSISTENCY.dwells_until_forgiven {
            self.variation_errors = 0;
        }
        let [back, drive] = &mut self.accepted;
        let count = if flank == Some(Flank::Drive) { &mut *drive } else { &mut *back };
        *count = count.saturating_add(1);
    }

    /// Discards the half-gap. If the half-gap was not trusted, all other parameters are in doubt too.
    fn discard_half_gap(&mut self) -> ParameterAction {
        let was_trusted = self.is_trusted();
        self.accepted = [0; 2];
        if was_trusted { ParameterAction::ResetHalfGap } else { ParameterAction::ResetAll }
    }

    /// Returns true once the half-gap has been confirmed on both flanks.
    pub fn is_trusted(&self) -> bool {
        let [back, drive] = self.accepted;
        back.min(drive) >= CONSISTENCY.trusted_dwells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Consistency with a trusted half-gap.
    fn trusted() -> Consistency {
        let mut consistency = Consistency::default();
        for _ in 0..CONSISTENCY.trusted_dwells {
            consistency.accept(Some(Flank::Drive));
            consistency.accept(Some(Flank::Back));
        }
        assert!(consistency.is_trusted());
        consistency
    }

    /// Verdict on force between the flanks that lasts for 24 intervals.
    fn lasting_force(consistency: &mut Consistency, deviation: DeviationSize) -> ParameterAction {
        for _ in 1..24 {
            assert_eq!(consistency.check_gap_force(Some(deviation)), ParameterAction::Keep);
        }
        consistency.check_gap_force(Some(deviation))
    }

    /// Verdict on two consecutive outliers.
    fn outliers(consistency: &mut Consistency, deviation: DeviationSize) -> ParameterAction {
        assert_eq!(consistency.reject(deviation, true), ParameterAction::Keep);
        let action = consistency.reject(deviation, true);
        consistency.outliers = 0;
        action
    }

    #[test]
    fn narrower_gap_is_variation_three_times() {
        let mut consistency = trusted();
        for _ in 0..3 {
            assert_eq!(
                lasting_force(&mut consistency, DeviationSize::WithinVariation),
                ParameterAction::InflateHalfGap
            );
        }
        assert_eq!(
            lasting_force(&mut consistency, DeviationSize::WithinVariation),
            ParameterAction::OutputEncoderFault
        );
    }

    #[test]
    fn variation_is_forgiven_after_64_dwells() {
        let fourth_error = |dwells| {
            let mut consistency = trusted();
            for _ in 0..3 {
                lasting_force(&mut consistency, DeviationSize::WithinVariation);
            }
            (0..dwells).for_each(|_| consistency.accept(Some(Flank::Drive)));
            lasting_force(&mut consistency, DeviationSize::WithinVariation)
        };
        assert_eq!(fourth_error(63), ParameterAction::OutputEncoderFault);
        assert_eq!(fourth_error(64), ParameterAction::InflateHalfGap);
    }

    #[test]
    fn trust_needs_32_dwells_on_each_flank() {
        let mut consistency = Consistency::default();
        (0..31).for_each(|_| consistency.accept(Some(Flank::Back)));
        (0..40).for_each(|_| consistency.accept(Some(Flank::Drive)));
        assert!(!consistency.is_trusted());
        consistency.accept(Some(Flank::Back));
        assert!(consistency.is_trusted());
    }

    #[test]
    fn gap_narrower_by_half_is_encoder_fault() {
        assert_eq!(lasting_force(&mut trusted(), DeviationSize::BeyondVariation), ParameterAction::OutputEncoderFault);
        assert_eq!(
            lasting_force(&mut Consistency::default(), DeviationSize::WithinVariation),
            ParameterAction::ResetAll
        );
    }

    #[test]
    fn interrupted_gap_force_is_ignored() {
        let mut consistency = trusted();
        for interval in 0..10 * u32::from(CONSISTENCY.gap_force_intervals) {
            let force =
                (interval % u32::from(CONSISTENCY.gap_force_intervals) != 0).then_some(DeviationSize::BeyondVariation);
            assert_eq!(consistency.check_gap_force(force), ParameterAction::Keep);
        }
    }

    #[test]
    fn two_outliers_inflate_or_reset_half_gap() {
        assert_eq!(outliers(&mut trusted(), DeviationSize::WithinTolerance), ParameterAction::Keep);
        assert_eq!(outliers(&mut trusted(), DeviationSize::WithinVariation), ParameterAction::InflateHalfGap);
        let mut consistency = trusted();
        assert_eq!(outliers(&mut consistency, DeviationSize::BeyondVariation), ParameterAction::ResetHalfGap);
        assert!(!consistency.is_trusted());
        assert_eq!(outliers(&mut consistency, DeviationSize::BeyondVariation), ParameterAction::ResetAll);
    }

    #[test]
    fn twelve_outliers_are_encoder_fault() {
        let (mut trusted, mut untrusted) = (Consistency::default(), Consistency::default());
        for _ in 1..12 {
            assert_ne!(trusted.reject(DeviationSize::WithinTolerance, true), ParameterAction::OutputEncoderFault);
            assert_ne!(untrusted.reject(DeviationSize::WithinTolerance, false), ParameterAction::ResetAll);
        }
        assert_eq!(trusted.reject(DeviationSize::WithinTolerance, true), ParameterAction::OutputEncoderFault);
        assert_eq!(untrusted.reject(DeviationSize::WithinTolerance, false), ParameterAction::ResetAll);
    }
}

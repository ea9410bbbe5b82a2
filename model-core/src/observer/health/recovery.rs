//! Readmission of an excluded output encoder, once it turns with the motor again.

use super::thresholds::OUTPUT_FAULT;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::SupervisorTable;

/// Kind of return of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Readmission {
    /// The encoder agrees with the estimated parameters.
    SameOffset,
    /// The encoder turns with the motor at another offset than the estimated one.
    NewOffset,
}

/// Evidence of a learning interval on an excluded encoder.
#[derive(Debug, Clone, Copy)]
pub struct OutputEvidence<T: Real> {
    /// In settled contact the flank, and the encoder's deflection less the predicted deflection [m].
    pub settled: Option<(Flank, T)>,
    /// Tolerance of agreement [m].
    pub tolerance: T,
    /// Outside settled contact, true if the deflection lies between the flanks.
    pub lies_in_gap: bool,
    /// Position of the output, if it is read [2^-32 turns].
    pub position: Option<u32>,
}

/// Readmission of the output encoder: agreement so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct OutputRecovery<T: Real> {
    /// Learning intervals in motion with agreement.
    agreeing_intervals: u16,
    /// Learning intervals in motion at a constant offset.
    steady_intervals: u16,
    /// Constant offset: deflection less the predicted deflection, on the back flank and on the drive flank [m].
    steady_offsets: [T; 2],
    /// Position of the output when it last moved [2^-32 turns].
    position: u32,
}
state_words! { struct OutputRecovery<T> { agreeing_intervals, steady_intervals, steady_offsets, position } }

impl<T: Real> OutputRecovery<T> {
    /// Starts anew after an exclusion.
    pub fn reset(&mut self) {
        *self = Self { position: self.position, ..Self::default() };
    }

    /// Judges one learning interval.
    pub fn step(&mut self, table: &SupervisorTable<T>, evidence: &OutputEvidence<T>) -> Option<Readmission> {
        let agrees = if let Some((flank, offset)) = evidence.settled {
            let [back, drive] = &mut self.steady_offsets;
            let steady_offset = if flank == Flank::Drive { drive } else { back };
            if (offset - *steady_offset).abs() > evidence.tolerance {
                *steady_offset = offset;
                self.steady_intervals = 0;
            }
            offset.abs() < evidence.tolerance
        } else {
            evidence.lies_in_gap
        };
        if !agrees {
            self.agreeing_intervals = 0;
        }
        // A stationary encoder that flickers does not turn.
        if let Some(position) = evidence.position
            && (position.wrapping_sub(self.position) as i32).unsigned_abs() >= table.moved
        {
            self.position = position;
            self.steady_intervals = self.steady_intervals.saturating_add(u16::from(evidence.settled.is_some()));
            self.agreeing_intervals = self.agreeing_intervals.saturating_add(u16::from(agrees));
        }
        if self.agreeing_intervals >= table.trusted_after {
            Some(Readmission::SameOffset)
        } else if self.steady_intervals >= table.trusted_after.saturating_mul(OUTPUT_FAULT.new_offset_factor) {
            Some(Readmission::NewOffset)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::supervisor;

    const TOLERANCE: f32 = 10e-6;
    /// Learning intervals of agreement and at a constant offset before readmission, and travel that proves motion, in
    /// the test table.
    const INTERVALS: u16 = 5;
    const INTERVALS_AT_OFFSET: u16 = 15;
    const TRAVEL: u32 = 1000;

    /// Steps `intervals` in motion with an offset on the drive flank, and returns the last result.
    fn steps(recovery: &mut OutputRecovery<f32>, offset: f32, intervals: u16, travel: u32) -> Option<Readmission> {
        let mut result = None;
        for _ in 0..intervals {
            let position = recovery.position.wrapping_add(travel);
            let settled = Some((Flank::Drive, offset));
            let evidence =
                OutputEvidence { settled, tolerance: TOLERANCE, lies_in_gap: false, position: Some(position) };
            result = recovery.step(&supervisor(), &evidence);
        }
        result
    }

    #[test]
    fn agreement_in_motion_readmits() {
        let mut recovery = OutputRecovery::default();
        assert_eq!(steps(&mut recovery, 9e-6, INTERVALS - 1, TRAVEL), None);
        assert_eq!(steps(&mut recovery, 9e-6, 1, TRAVEL), Some(Readmission::SameOffset));
    }

    #[test]
    fn stationary_encoder_is_not_readmitted() {
        let mut recovery = OutputRecovery::default();
        assert_eq!(steps(&mut recovery, 0.0, 100, TRAVEL - 1), None);
    }

    #[test]
    fn constant_offset_readmits_later() {
        let mut recovery = OutputRecovery::default();
        assert_eq!(steps(&mut recovery, 50e-6, INTERVALS_AT_OFFSET - 1, TRAVEL), None);
        assert_eq!(steps(&mut recovery, 50e-6, 1, TRAVEL), Some(Readmission::NewOffset));
    }

    #[test]
    fn drifting_offset_starts_anew() {
        let mut recovery = OutputRecovery::default();
        steps(&mut recovery, 50e-6, INTERVALS_AT_OFFSET - 1, TRAVEL);
        assert_eq!(steps(&mut recovery, 61e-6, 1, TRAVEL), None);
        assert_eq!(steps(&mut recovery, 61e-6, INTERVALS_AT_OFFSET - 2, TRAVEL), None);
        assert_eq!(steps(&mut recovery, 61e-6, 1, TRAVEL), Some(Readmission::NewOffset));
    }

    #[test]
    fn disagreement_clears_agreement() {
        let mut recovery = OutputRecovery::default();
        steps(&mut recovery, 0.0, INTERVALS - 1, TRAVEL);
        steps(&mut recovery, 11e-6, 1, TRAVEL);
        assert_eq!(steps(&mut recovery, 0.0, INTERVALS - 1, TRAVEL), None);
    }

    #[test]
    fn offset_of_nan_is_not_readmitted() {
        let mut recovery = OutputRecovery::default();
        assert_eq!(steps(&mut recovery, f32::NAN, INTERVALS, TRAVEL), None);
    }

    #[test]
    fn open_gap_needs_no_contact() {
        let mut recovery = OutputRecovery::<f32>::default();
        let mut result = None;
        for interval in 1..=u32::from(INTERVALS) {
            let position = Some(interval * TRAVEL);
            let evidence = OutputEvidence { settled: None, tolerance: TOLERANCE, lies_in_gap: true, position };
            result = recovery.step(&supervisor(), &evidence);
        }
        assert_eq!(result, Some(Readmission::SameOffset));
    }
}

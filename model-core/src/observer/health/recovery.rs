//! Readmission of an excluded output encoder, once it turns with the motor again.

use super::thresholds::OUTPUT_FAULT;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::SupervisorTable;

/// Kind of return of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Readmission {
    /// The encoder agrees with the estimated parameters.
    SameOffset,
    /// The encoder turns with the motor at another offset than the estimated one.
    NewOffset,
}

/// Evidence for an excluded encoder.
#[derive(Debug, Clone, Copy)]
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

impl<T: Real> OutputRecovery<T> {
    pub fn new() -> Self {
        Self { agreeing_intervals: 0, steady_intervals: 0, steady_offsets: [T::ZERO; 2], position: 0 }
    }

    /// Starts anew after an exclusion.
    pub fn reset(&mut self) {
        *self = Self { position: self.position, ..Self::new() };
    }

    /// Judges one learning interval. `settled`: in settled contact the flank and the encoder's deflection less the
    /// predicted deflection [m]. `tolerance`: tolerance of agreement [m]. `lies_in_gap`: outside settled contact, true if the
    /// deflection lies between the flanks. `position`: position of the output, if it is read [2^-32 turns].
    pub fn step(
        &mut self,
        table: &SupervisorTable<T>,
        settled: Option<(Flank, T)>,
        tolerance: T,
        lies_in_gap: bool,
        position: Option<u32>,
    ) -> Option<Readmission> {
        let agrees = if let Some((flank, offset)) = settled {
            let [back, drive] = &mut self.steady_offsets;
            let steady_offset = if flank == Flank::Drive { drive } else { back };
            if (offset - *steady_offset).abs() > tolerance {
                *steady_offset = offset;
                self.steady_intervals = 0;
            }
            offset.abs() < tolerance
        } else {
            lies_in_gap
        };
        if !agrees {
            self.agreeing_intervals = 0;
        }
        // A stationary encoder that flickers does not turn.
        if let Some(position) = position
            && (position.wrapping_sub(self.position) as i32).unsigned_abs() >= table.moved
        {
            self.position = position;
            self.steady_intervals = self.steady_intervals.saturating_add(u16::from(settled.is_some()));
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

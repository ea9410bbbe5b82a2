//! Readmission of an excluded output encoder, once it turns with the motor again.

use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::SupervisorTable;

/// Factor on the time of agreement for an encoder that turns with the motor at another constant offset [-].
const OTHERWISE: u16 = 3;

/// Kind of return of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Return {
    /// The encoder agrees with the estimated parameters.
    AsLearnt,
    /// The encoder turns with the motor at another offset than the estimated one.
    Otherwise,
}

/// Evidence for an excluded encoder.
#[derive(Debug, Clone, Copy)]
pub struct Recovery<T: Real> {
    /// Learning intervals in motion with agreement.
    agreed_for: u16,
    /// Learning intervals in motion at a constant offset.
    steady_for: u16,
    /// Constant offset: deflection less the predicted deflection, on the back flank and on the drive flank [m].
    steady: [T; 2],
    /// Position of the output when it last moved [2^-32 turns].
    place: u32,
}

impl<T: Real> Recovery<T> {
    pub fn new() -> Self {
        Self { agreed_for: 0, steady_for: 0, steady: [T::ZERO; 2], place: 0 }
    }

    /// Starts anew after an exclusion.
    pub fn begin(&mut self) {
        *self = Self { place: self.place, ..Self::new() };
    }

    /// Judges one learning interval. `settled`: in settled contact the flank and the encoder's deflection less the
    /// predicted deflection [m]. `room`: tolerance of agreement [m]. `between`: outside settled contact, true if the
    /// deflection lies between the flanks. `place`: position of the output, if it is read [2^-32 turns].
    pub fn step(
        &mut self,
        table: &SupervisorTable<T>,
        settled: Option<(Flank, T)>,
        room: T,
        between: bool,
        place: Option<u32>,
    ) -> Option<Return> {
        let agrees = if let Some((flank, beyond)) = settled {
            let [back, drive] = &mut self.steady;
            let steady = if flank == Flank::Drive { drive } else { back };
            if (beyond - *steady).abs() > room {
                *steady = beyond;
                self.steady_for = 0;
            }
            beyond.abs() < room
        } else {
            between
        };
        if !agrees {
            self.agreed_for = 0;
        }
        // A stationary encoder that flickers does not turn.
        if let Some(place) = place
            && (place.wrapping_sub(self.place) as i32).unsigned_abs() >= table.moved
        {
            self.place = place;
            self.steady_for = self.steady_for.saturating_add(u16::from(settled.is_some()));
            self.agreed_for = self.agreed_for.saturating_add(u16::from(agrees));
        }
        if self.agreed_for >= table.trusted_after {
            Some(Return::AsLearnt)
        } else if self.steady_for >= table.trusted_after.saturating_mul(OTHERWISE) {
            Some(Return::Otherwise)
        } else {
            None
        }
    }
}

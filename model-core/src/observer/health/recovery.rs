//! When an output encoder that was given up is taken back: when it turns with the motor again.

use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::SupervisorTable;

/// An encoder that turns with the motor must do so this many times longer if it says anything else than what was learnt.
const OTHERWISE: u16 = 3;

/// How the encoder comes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Return {
    /// It says what was learnt.
    AsLearnt,
    /// It turns with the motor, but something else was learnt.
    Otherwise,
}

/// What speaks for an encoder that is not used.
#[derive(Debug, Clone, Copy)]
pub struct Recovery<T: Real> {
    /// Learning intervals in motion in which it said what was learnt.
    agreed_for: u16,
    /// Learning intervals in motion in which it said the same as before.
    steady_for: u16,
    /// And what: the deflection beyond what was learnt, on the back flank and on the drive flank [m].
    steady: [T; 2],
    /// Where the output was when it moved last [2^-32 turns].
    place: u32,
}

impl<T: Real> Recovery<T> {
    pub fn new() -> Self {
        Self { agreed_for: 0, steady_for: 0, steady: [T::ZERO; 2], place: 0 }
    }

    /// The encoder was given up now.
    pub fn begin(&mut self) {
        *self = Self { place: self.place, ..Self::new() };
    }

    /// Once a learning interval: in settled contact the flank, and by how much the deflection that the encoder would give
    /// is beyond what was learnt there [m]; `room` is what may be between deflections that agree [m]. Elsewhere, whether
    /// that deflection is between the flanks. Besides, where the output is [2^-32 turns], if it is heard of at all.
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
        // An encoder that stands still and flickers does not turn.
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

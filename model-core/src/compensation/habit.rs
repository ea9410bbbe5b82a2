//! Which way a joint at rest is likely to start: on or back, as it did the last time. Most motions that nobody foresees go
//! to and fro or on and on, and which of them it is the last start tells. What is made of it is left to `flank`.

use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, sign};

/// What the last rests and starts were like.
#[derive(Debug, Clone, Copy)]
pub(super) struct Habit<T: Real> {
    /// 1 or -1: the way that the motion went last; 0 before it has.
    came: T,
    /// 1 if it went on from its last rest, -1 if it went back, 0 before it has done either.
    goes_on: T,
    /// Whether it has been asked to rest since it went.
    rests: bool,
    /// For how long the link has stood still, as far as that matters [s].
    stood: T,
    /// Where, from the set-point [rad].
    place: T,
}

impl<T: Real> Habit<T> {
    pub fn new() -> Self {
        Self { came: T::ZERO, goes_on: T::ZERO, rests: false, stood: T::ZERO, place: T::ZERO }
    }

    /// Takes in a period and which way it is asked to go; 1 or -1: the way that a joint at rest is likely to start, 0 if
    /// nothing tells or if its link does not stand still: one that no friction holds needs its flank for itself.
    pub fn follow(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, course: T, rests: bool) -> T {
        if rests {
            self.rests = true;
            let enough = T::QUARTER * tables.hunting;
            // Its speed is too rough: it flickers with the last count of the encoder.
            if (situation.error - self.place).abs() > T::EIGHTH * situation.half {
                (self.place, self.stood) = (situation.error, T::ZERO);
            }
            self.stood = clamp(self.stood + tables.period, T::ZERO, enough);
            return if self.stood < enough { T::ZERO } else { self.came * self.goes_on };
        }
        self.stood = T::ZERO;
        let goes = sign(course);
        if goes != T::ZERO {
            if self.rests {
                self.goes_on = self.came * goes;
            }
            (self.came, self.rests) = (goes, false);
        }
        T::ZERO
    }
}

//! Readings that come late, by their own time: what a side was then is compared with them, and what they teach of then is
//! carried on to now. What is done without one is left to `follow`.
//!
//! A filter that took the surprise of then for one of now would answer its own answers, and swing up as soon as readings
//! are about as old as it is fast.

use crate::numbers::Real;

/// Periods over which motor and link go on as they went.
const MISSING: u32 = 2;

/// Late readings in a row after which it is the line that is late.
const FEW: u8 = 4;

/// Periods in which readings must be on time again until that is over: what the motor side took the forces for has faded.
const OVER: u8 = 32;

/// How the motor was heard of in a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Heard {
    /// As it is now.
    Now,
    /// Not in this period, or that and the one before: it goes on as it went.
    Missed,
    /// Not for longer: the force since is a guess, so nothing that stands on it is vouched for, or learnt from.
    Missing,
    /// As it was: likewise.
    Late,
    /// Not, or as it was too long ago.
    Not,
}

/// How late readings of the motor have been.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lateness {
    /// Age of the last, in parts of a period.
    age: u8,
    /// Late ones in a row or, once they are more than few, periods until they are forgotten.
    many: u8,
}

/// Parts of a period.
const PARTS: u32 = 16;

/// Parts of a period by which a reading is older than the one before, if it is the same again.
const AGAIN: u32 = 12;

impl Lateness {
    /// Takes a reading's age, `None` for one that is too old, and the length of a period; both in ticks.
    #[inline]
    pub fn hear(&mut self, age: Option<u32>, period: u32) -> Heard {
        match age {
            Some(age) if age < period => {
                self.age = 0;
                self.many = self.many.saturating_sub(1);
                Heard::Now
            }
            _ => self.hear_late(age, period),
        }
    }

    #[cold]
    fn hear_late(&mut self, age: Option<u32>, period: u32) -> Heard {
        let parts =
            age.and_then(|age| age.saturating_mul(PARTS).checked_div(period)).map_or(u8::MAX, |parts| parts as u8);
        let before = u32::from(core::mem::replace(&mut self.age, parts));
        let again = u32::from(parts) >= before + AGAIN;
        let heard = match age {
            Some(age) if again && age < period.saturating_mul(MISSING).saturating_add(period / 2) => Heard::Missed,
            Some(_) if again => Heard::Missing,
            Some(_) => Heard::Late,
            None => Heard::Not,
        };
        self.many = match heard {
            Heard::Now | Heard::Missed => self.many.saturating_sub(1),
            Heard::Missing | Heard::Late if self.many < FEW => self.many + 1,
            _ => FEW + OVER,
        };
        heard
    }

    /// Whether they have been late for long.
    pub fn lasts(&self) -> bool {
        self.many > FEW
    }
}

/// One side between a reading and now.
#[derive(Debug, Clone, Copy)]
pub(super) struct Since<T: Real> {
    /// How old the reading is, in periods.
    pub periods: T,
    /// Length of one [s].
    pub period: T,
    /// Change of speed in a period [rad/s].
    pub quickening: T,
    /// The same for each newton metre of the torque that is estimated [rad/(s N m)].
    pub by_torque: T,
}

impl<T: Real> Since<T> {
    /// By how much the shaft is beyond the reading, if it goes so fast now [rad].
    pub fn went(&self, speed: T) -> T {
        self.periods * self.period * (speed - T::HALF * self.periods * self.quickening)
    }

    /// What corrections of angle, speed and torque then come to now.
    pub fn carried(&self, gain: &[T; 3]) -> [T; 3] {
        let [angle, speed, torque] = *gain;
        let quicker = self.periods * self.by_torque * torque;
        [angle + self.periods * self.period * (speed + T::HALF * quicker), speed + quicker, torque]
    }
}

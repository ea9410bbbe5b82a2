//! Readings that come late, by their own time: what a side was then is compared with them, and what they teach of then is
//! carried on to now. How old a reading may be is said here; what is done without one is left to `follow`.
//!
//! A filter that took the surprise of then for one of now would answer its own answers, and swing up as soon as readings
//! are about as old as it is fast.

use crate::real::Real;

/// Periods up to which torques that are known now serve for the time since a reading: an older one counts as lost.
pub(super) const OLDEST: u32 = 10;

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
    /// When the last was taken.
    taken: u32,
    /// Late ones in a row or, once they are more than few, periods until they are forgotten.
    many: u8,
}

impl Lateness {
    /// Takes a reading's time and age, `None` for one that is too old.
    pub fn hear<T: Real>(&mut self, time: u32, age: Option<T>, period: T) -> Heard {
        let again = core::mem::replace(&mut self.taken, time).wrapping_sub(time) as i32 >= 0;
        let heard = match age {
            Some(age) if age < period => Heard::Now,
            Some(age) if again && age < (T::THREE - T::HALF) * period => Heard::Missed,
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

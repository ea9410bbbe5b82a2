//! Readings that come late, by their own time: what a side was then is compared with them, and what they teach of then is
//! carried on to now. How old a reading may be is said here; what is done without one is left to `follow`.
//!
//! A filter that took the surprise of then for one of now would answer its own answers, and swing up as soon as readings
//! are about as old as it is fast.

use crate::real::Real;

/// Periods up to which torques that are known now serve for the time since a reading: an older one counts as lost.
pub(super) const OLDEST: u32 = 10;

/// How the motor was heard of in a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Heard {
    /// As it is now.
    Now,
    /// As it was: the force in between is a guess, so nothing that stands on it is vouched for, or learnt from.
    Late,
    /// Not, or as it was too long ago.
    Not,
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

//! Readings that are older than a control period, by their own time: the prediction of then is compared with them, and
//! the correction of then is carried on to now.
//!
//! A filter that took the innovation of then for one of now would answer its own answers, and swing up as soon as readings
//! are about as old as it is fast.

use crate::numbers::Real;

/// One side between a reading and now.
#[derive(Debug, Clone, Copy)]
pub struct Delayed<T: Real> {
    /// How old the reading is, in periods.
    pub periods: T,
    /// Length of one [s].
    pub period: T,
    /// Change of speed in a period [rad/s].
    pub speed_change: T,
    /// The same for each newton metre of the torque that is estimated [rad/(s N m)].
    pub speed_per_torque: T,
}

impl<T: Real> Delayed<T> {
    /// Angle by which the shaft is beyond the reading, at its present speed [rad/s]; in rad.
    pub fn travel(&self, speed: T) -> T {
        self.periods * self.period * (speed - T::HALF * self.periods * self.speed_change)
    }

    /// Gains of then as they are now: of angle, speed and torque.
    pub fn gain_now(&self, gain: &[T; 3]) -> [T; 3] {
        let [angle, speed, torque] = *gain;
        let faster = self.periods * self.speed_per_torque * torque;
        [angle + self.periods * self.period * (speed + T::HALF * faster), speed + faster, torque]
    }
}

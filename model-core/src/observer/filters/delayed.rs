//! Correction by a reading older than a control period:
//!
//! ```text
//! (O3)  z = n T (w - n T w'/2) - a,   state += exp(A n T) G z
//! ```
//!
//! Symbols: n = `periods`, T = `period`, T w' = `speed_change`, n T (w - n T w'/2) = `travel`, exp(A n T) G =
//! `gain_now`.
//!
//! Treating a delayed reading as current closes a second feedback path: with an 18-bit encoder the filter is unstable
//! from 2 periods of delay on.

use crate::numbers::Real;

/// State change of one side between a reading and now.
#[derive(Debug, Clone, Copy)]
pub struct Delayed<T: Real> {
    /// Age n of the reading [control periods].
    pub periods: T,
    /// Control period T [s].
    pub period: T,
    /// Change of speed per period [rad/s].
    pub speed_change: T,
    /// Change of speed per period and per newton metre of the estimated torque [rad/(s N m)].
    pub speed_per_torque: T,
}

impl<T: Real> Delayed<T> {
    /// Angle from the reading to now, with the present speed [rad/s]; in rad.
    pub fn travel(&self, speed: T) -> T {
        self.periods * self.period * (speed - T::HALF * self.periods * self.speed_change)
    }

    /// Carries the gains of angle, speed and torque from the time of the reading to now.
    pub fn gain_now(&self, gain: &[T; 3]) -> [T; 3] {
        let [angle, speed, torque] = *gain;
        let faster = self.periods * self.speed_per_torque * torque;
        [angle + self.periods * self.period * (speed + T::HALF * faster), speed + faster, torque]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn delayed(periods: f32) -> Delayed<f32> {
        Delayed { periods, period: 0.1, speed_change: 2.0, speed_per_torque: -4.0 }
    }

    #[test]
    fn present_reading_needs_no_correction() {
        assert_eq!(delayed(0.0).travel(5.0), 0.0);
        assert_eq!(delayed(0.0).gain_now(&[0.5, 3.0, -1.0]), [0.5, 3.0, -1.0]);
    }

    #[test]
    fn travel_counts_from_speed_at_reading() {
        // Speed 5 now and 1 two periods ago: 3 on average, over 0.2 s.
        assert!((delayed(2.0).travel(5.0) - 0.6).abs() < 1e-6);
    }

    #[test]
    fn gain_is_carried_to_now() {
        // A torque of -1 for two periods changes the speed by 8, and the angle by 0.2 x (3 + 4).
        let [angle, speed, torque] = delayed(2.0).gain_now(&[0.5, 3.0, -1.0]);
        assert!((angle - 1.9).abs() < 1e-6 && speed == 11.0 && torque == -1.0);
    }
}

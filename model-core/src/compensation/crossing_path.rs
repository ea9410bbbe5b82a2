//! Path of a crossing: a ramp to a steady speed, steady speed, a ramp to the landing speed. Loose planets are struck
//! anywhere on the way, so that the highest speed determines the force: a path with a higher peak speed would strike
//! harder without being faster.
//!
//! ```text
//! (K8)  v_x = (end - start - ramp/2 (start speed + end speed))/(T_c - ramp)
//!       on a ramp, with s = time/ramp:   speed = start speed + (v_x - start speed) (3 s^2 - 2 s^3)
//! ```
//!
//! Symbols: v_x = `steady`, T_c = `crossing.duration`, ramp = `crossing.ramp`.

use super::crossing_timing::CrossingTiming;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Path over time.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CrossingPath<T: Real> {
    start: [T; 2],
    end: [T; 2],
    /// Steady speed between the ramps [rad/s].
    steady: T,
    crossing: CrossingTiming<T>,
    inverse_ramp: T,
}
state_words! { struct CrossingPath<T> { start, end, steady, crossing, inverse_ramp } }

impl<T: Real> CrossingPath<T> {
    /// Creates a path from position and rate to position and rate.
    pub fn new(start: [T; 2], end: [T; 2], crossing: CrossingTiming<T>) -> Self {
        let CrossingTiming { duration, ramp } = crossing;
        let long = duration - ramp;
        let at_full = end[0] - start[0] - T::HALF * ramp * (start[1] + end[1]);
        let steady = if long > T::ZERO { at_full / long } else { T::ZERO };
        let inverse_ramp = if ramp > T::ZERO { T::ONE / ramp } else { T::ZERO };
        Self { start, end, steady, crossing, inverse_ramp }
    }

    /// Duration of the path [s].
    pub fn duration(&self) -> T {
        self.crossing.duration
    }

    /// Position, rate and acceleration at a time since the start; outside the path, extrapolated at the rate of its
    /// ends.
    pub fn at(&self, time: T) -> [T; 3] {
        let CrossingTiming { duration, ramp } = self.crossing;
        let left = duration - time;
        let [from, to] = [self.start, self.end];
        if left <= T::ZERO {
            [to[0] - left * to[1], to[1], T::ZERO]
        } else if time <= T::ZERO {
            [from[0] + time * from[1], from[1], T::ZERO]
        } else if time < ramp {
            let [way, rate, acceleration] = self.rise(time, from[1]);
            [from[0] + way, rate, acceleration]
        } else if left < ramp {
            let [way, rate, acceleration] = self.rise(left, to[1]);
            [to[0] - way, rate, -acceleration]
        } else {
            let way = T::HALF * ramp * (from[1] + self.steady) + (time - ramp) * self.steady;
            [from[0] + way, self.steady, T::ZERO]
        }
    }

    /// Travel, rate and acceleration on the ramp from a rate to the steady speed; the acceleration is zero at both
    /// ends.
    fn rise(&self, time: T, from: T) -> [T; 3] {
        let s = time * self.inverse_ramp;
        let by = self.steady - from;
        let square = s * s;
        [
            time * (from + by * square * (T::ONE - T::HALF * s)),
            from + by * square * (T::THREE - T::TWO * s),
            T::from_i32(6) * by * s * (T::ONE - s) * self.inverse_ramp,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CROSSING: CrossingTiming<f64> = CrossingTiming { duration: 6e-3, ramp: 1.5e-3 };

    fn path() -> CrossingPath<f64> {
        CrossingPath::new([0.1, 0.3], [0.104, 0.2], CROSSING)
    }

    #[test]
    fn path_leads_from_end_to_end() {
        for (time, place, rate) in [(0.0, 0.1, 0.3), (6e-3, 0.104, 0.2)] {
            for beside in [-1e-9, 1e-9] {
                let [at, speed, acceleration] = path().at(time + beside);
                assert!((at - place).abs() < 1e-8 && (speed - rate).abs() < 1e-6, "{at} {speed}");
                assert!(acceleration.abs() < 0.01, "{acceleration}");
            }
        }
    }

    #[test]
    fn rate_and_acceleration_are_the_slopes_of_place_and_rate() {
        let step = 1e-7;
        for period in 1..60 {
            let time = f64::from(period) * 1e-4 + 5e-5;
            let [before, now, after] = [-step, 0.0, step].map(|by| path().at(time + by));
            assert!(((after[0] - before[0]) / (2.0 * step) - now[1]).abs() < 1e-6);
            assert!(((after[1] - before[1]) / (2.0 * step) - now[2]).abs() < 1e-2);
        }
    }

    #[test]
    fn path_never_exceeds_the_steady_speed() {
        let rest = CrossingPath::new([0.0, 0.0], [3.78e-3, 0.0], CROSSING);
        let highest = (0..600).map(|part| rest.at(f64::from(part) * 1e-5)[1]).fold(0.0, f64::max);
        assert!((highest - 3.78e-3 / (CROSSING.duration - CROSSING.ramp)).abs() < 1e-12);
    }
}

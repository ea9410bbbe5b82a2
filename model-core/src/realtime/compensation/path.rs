//! The path of a crossing: the polynomial of fifth degree from one position and speed to another with no acceleration at
//! either end; between points at rest it is the one of least jerk.

use crate::real::Real;

/// A path over time.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Path<T: Real> {
    start: [T; 2],
    end: [T; 2],
    duration: T,
    inverse: T,
}

impl<T: Real> Path<T> {
    /// From position and rate to position and rate.
    pub fn new(start: [T; 2], end: [T; 2], duration: T) -> Self {
        let inverse = if duration > T::ZERO { T::ONE.over(duration) } else { T::ZERO };
        Self { start, end, duration, inverse }
    }

    /// How long it takes [s].
    pub fn duration(&self) -> T {
        self.duration
    }

    /// Position, rate and acceleration at a time since the start; before and past its ends it goes on at
    /// their rates.
    pub fn at(&self, time: T) -> [T; 3] {
        let n = T::from_i32;
        if time >= self.duration {
            return [self.end[0] + (time - self.duration) * self.end[1], self.end[1], T::ZERO];
        }
        if time <= T::ZERO {
            return [self.start[0] + time * self.start[1], self.start[1], T::ZERO];
        }
        let s = time * self.inverse;
        let way = self.end[0] - self.start[0];
        let (v0, v1) = (self.start[1] * self.duration, self.end[1] * self.duration);
        let c3 = n(10) * way - n(6) * v0 - n(4) * v1;
        let c4 = n(-15) * way + n(8) * v0 + n(7) * v1;
        let c5 = n(6) * way - n(3) * (v0 + v1);
        let square = s * s;
        [
            self.start[0] + s * (v0 + square * (c3 + s * (c4 + s * c5))),
            (v0 + square * (n(3) * c3 + s * (n(4) * c4 + s * n(5) * c5))) * self.inverse,
            s * (n(6) * c3 + s * (n(12) * c4 + s * n(20) * c5)) * self.inverse * self.inverse,
        ]
    }
}

//! Integration of a sub-step (S9) for x'' = a(x, x', t), a smooth: fourth order with two evaluations. Derivation and
//! stability limits: docs/theory/step.md.
//!
//! In units in which the sub-step lasts 1 and accelerations are counted in sixths (A = a/6), with A_- (`before`) half a
//! sub-step earlier, A_0 (`now`) at the start, A_m (`middle`) in the middle and A_1 (`last`) at the end:
//!
//! x_m = x + V/2 + A_0 - A_-/4     V_m = V + (9 A_0 - 3 A_-)/2
//! x_1 = x + V + A_0 + 2 A_m       V_1 = V + A_0 + 4 A_m + A_1 (Simpson's rule)
//!
//! A_1 is evaluated at x_1 and the rate V + 6 A_m of the midpoint rule, and is A_0 of the next sub-step.

use crate::gears::contact::AppliedAcceleration;
use crate::gears::state::{MotionInPlace, Relative};
use crate::gears::tables::Mobility;
use crate::numbers::Real;

/// One coordinate: position, rate, and acceleration now and half a sub-step earlier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate<T> {
    /// Position.
    pub position: T,
    /// Rate, as the distance travelled in a sub-step.
    pub rate: T,
    /// Acceleration now, in sixths.
    pub now: T,
    /// Acceleration half a sub-step earlier, in sixths.
    pub before: T,
}

/// Position and rate of a coordinate at a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point<T> {
    /// Position.
    pub position: T,
    /// Rate.
    pub rate: T,
}

impl<T: Real> Point<T> {
    /// Returns `self - other`.
    #[inline(always)]
    pub fn minus(self, other: Self) -> Self {
        Self { position: self.position - other.position, rate: self.rate - other.rate }
    }
}

impl<T: Real> Coordinate<T> {
    /// Coordinate at rest at zero.
    pub const ZERO: Self = Self { position: T::ZERO, rate: T::ZERO, now: T::ZERO, before: T::ZERO };

    /// Returns position and rate.
    #[inline(always)]
    pub fn point(&self) -> Point<T> {
        Point { position: self.position, rate: self.rate }
    }

    /// Returns position and rate in the middle of the sub-step, x_m and V_m of (S9).
    #[inline(always)]
    pub fn middle(&self) -> Point<T> {
        let Self { position, rate, now, before } = *self;
        Point {
            position: position + T::HALF * rate + now - T::QUARTER * before,
            rate: rate + (T::FOUR + T::HALF) * now - (T::ONE + T::HALF) * before,
        }
    }

    /// Advances to the end of the sub-step, except for the term added by `finish`; returns x_1 and the predicted rate
    /// V + 6 A_m.
    #[inline(always)]
    pub fn predict(&mut self, middle: T) -> Point<T> {
        let Self { position, rate, now, .. } = *self;
        let predicted = rate + T::SIX * middle;
        // Summing the change first rounds the position only once.
        self.position = position + (rate + now + T::TWO * middle);
        self.rate = rate + now + T::FOUR * middle;
        self.before = middle;
        Point { position: self.position, rate: predicted }
    }

    /// Adds the last term A_1 of Simpson's rule and stores A_1 for the next sub-step.
    #[inline(always)]
    pub fn finish(&mut self, last: T) {
        self.rate += last;
        self.now = last;
    }
}

/// All relative coordinates (S1); the unit of time is a sub-step.
#[derive(Debug, Clone)]
pub struct SubstepState<T, const N: usize> {
    /// u_s - u_pi - u_c of every planet, without imposed error.
    pub planets: [Coordinate<T>; N],
    /// u_s - 2 u_c.
    pub gap: Coordinate<T>,
    /// u_c - u_l.
    pub wind_up: Coordinate<T>,
}

impl<T: Real, const N: usize> SubstepState<T, N> {
    /// State before any motion is set.
    pub const EMPTY: Self = Self { planets: [Coordinate::ZERO; N], gap: Coordinate::ZERO, wind_up: Coordinate::ZERO };

    /// Sets positions and rates from a motion; accelerations stay unchanged.
    #[inline(always)]
    pub fn set_motion(&mut self, motion: &MotionInPlace<T, N>, length: T) {
        self.for_each(motion.position, |coordinate, position| coordinate.position = position);
        self.set_rates(motion.rate, length);
    }

    /// Sets the rates from a motion; positions stay as the last sub-step left them.
    #[inline(always)]
    pub fn set_rates(&mut self, rates: &Relative<T, N>, length: T) {
        self.for_each(rates, |coordinate, rate| coordinate.rate = length * rate);
    }

    /// Adds the accelerations of a change of torque to both stored accelerations, as if the torque had always acted.
    #[inline(always)]
    pub fn shift_accelerations(&mut self, applied: &AppliedAcceleration<T>, mobility: &Mobility<T>) {
        self.for_each(&applied.relative(mobility), |coordinate, more| {
            coordinate.now += more;
            coordinate.before += more;
        });
    }

    /// Writes positions and rates to a motion. `length` is the length of a sub-step, `per_length` its inverse. Rates are
    /// updated by their change, so that a rate that no force has changed keeps its bits.
    #[inline(always)]
    pub fn move_to(&self, length: T, per_length: T, motion: MotionInPlace<T, N>) {
        let MotionInPlace { position, rate } = motion;
        let take = |coordinate: &Coordinate<T>, position: &mut T, rate: &mut T| {
            *position = coordinate.position;
            *rate += per_length * (coordinate.rate - length * *rate);
        };
        for i in 0..N {
            take(&self.planets[i], &mut position.planets[i], &mut rate.planets[i]);
        }
        take(&self.gap, &mut position.gap, &mut rate.gap);
        take(&self.wind_up, &mut position.wind_up, &mut rate.wind_up);
    }

    /// Calls `act` for every coordinate with its value.
    #[inline(always)]
    pub fn for_each(&mut self, values: &Relative<T, N>, mut act: impl FnMut(&mut Coordinate<T>, T)) {
        for i in 0..N {
            act(&mut self.planets[i], values.planets[i]);
        }
        act(&mut self.gap, values.gap);
        act(&mut self.wind_up, values.wind_up);
    }
}

//! The method of a sub-step for x'' = a(x, x', t), a smooth: two evaluations for fourth order. Where it comes from and
//! how far it is stable is in docs/step.md; what the accelerations are is the caller's business.
//!
//! In units in which the sub-step lasts 1 and accelerations are counted in sixths (A = a/6), with A_- half a step
//! before, A_0 now, A_m in the middle and A_1 at the end:
//!
//! x_m = x + V/2 + A_0 - A_-/4     V_m = V + (9 A_0 - 3 A_-)/2
//! x_1 = x + V + A_0 + 2 A_m       V_1 = V + A_0 + 4 A_m + A_1 (Simpson's rule)
//!
//! A_1 is taken at x_1 and the rate V + 6 A_m of the midpoint rule, and serves the next sub-step as A_0.

use crate::real::Real;

/// One coordinate: position and rate, its acceleration now and half a sub-step before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate<T> {
    /// Position.
    pub position: T,
    /// Way that its rate goes in a sub-step.
    pub rate: T,
    /// Acceleration now, in sixths.
    pub now: T,
    /// Acceleration half a sub-step before, in sixths.
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
    /// What is left of it beyond another.
    #[inline(always)]
    pub fn less(self, other: Self) -> Self {
        Self { position: self.position - other.position, rate: self.rate - other.rate }
    }
}

impl<T: Real> Coordinate<T> {
    /// At rest at zero.
    pub const ZERO: Self = Self { position: T::ZERO, rate: T::ZERO, now: T::ZERO, before: T::ZERO };

    /// Where it is.
    #[inline(always)]
    pub fn point(&self) -> Point<T> {
        Point { position: self.position, rate: self.rate }
    }

    /// Where it is in the middle of the sub-step.
    #[inline(always)]
    pub fn middle(&self) -> Point<T> {
        let Self { position, rate, now, before } = *self;
        Point {
            position: position + T::HALF * rate + now - T::QUARTER * before,
            rate: rate + (T::FOUR + T::HALF) * now - (T::ONE + T::HALF) * before,
        }
    }

    /// Goes to the end of the sub-step but for what `finish` adds; the rate that is returned is foreseen.
    #[inline(always)]
    pub fn arrive(&mut self, middle: T) -> Point<T> {
        let Self { position, rate, now, .. } = *self;
        let foreseen = rate + T::SIX * middle;
        self.position = position + rate + now + T::TWO * middle;
        self.rate = rate + now + T::FOUR * middle;
        self.before = middle;
        Point { position: self.position, rate: foreseen }
    }

    /// The acceleration at the end, for the last part of Simpson's rule and for the next sub-step.
    #[inline(always)]
    pub fn finish(&mut self, last: T) {
        self.rate += last;
        self.now = last;
    }
}

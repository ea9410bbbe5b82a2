//! The method of a sub-step for x'' = a(x, x', t), a smooth: two evaluations for fourth order. Where it comes from and
//! how far it is stable is in docs/step.md; what the accelerations are is the caller's business.
//!
//! With a_- half a step before, a_0 now, a_m in the middle and a_1 at the end, and x''' from (a_0 - a_-) in the middle:
//!
//! x_m = x + h/2 v + h^2/6 a_0 - h^2/24 a_-      v_m = v + 3h/4 a_0 - h/4 a_-
//! x_1 = x + h v + h^2/6 a_0 + h^2/3 a_m         v_1 = v + h/6 a_0 + 2h/3 a_m + h/6 a_1 (Simpson's rule)
//!
//! a_1 is taken at x_1 and the rate that a parabola through a_-, a_0, a_m gives, and serves the next step as a_0.

use crate::real::Real;

/// One coordinate: position and rate, its acceleration now and half a sub-step before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate<T> {
    /// Position.
    pub position: T,
    /// Rate.
    pub rate: T,
    /// Acceleration now.
    pub now: T,
    /// Acceleration half a sub-step before.
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

/// The step as the stages need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights<T> {
    whole: T,
    half: T,
    quarter: T,
    three_quarters: T,
    sixth: T,
    third: T,
    two_thirds: T,
    seven_sixths: T,
    square_sixth: T,
    square_third: T,
    square_24th: T,
}

impl<T: Real> Weights<T> {
    /// Of a sub-step.
    pub fn new(step: T) -> Self {
        let (half, sixth) = (T::HALF * step, T::SIXTH * step);
        let (quarter, third, square_sixth) = (T::HALF * half, T::TWO * sixth, sixth * step);
        Self {
            whole: step,
            half,
            quarter,
            three_quarters: half + quarter,
            sixth,
            third,
            two_thirds: third + third,
            seven_sixths: step + sixth,
            square_sixth,
            square_third: T::TWO * square_sixth,
            square_24th: T::HALF * T::HALF * square_sixth,
        }
    }
}

impl<T: Real> Coordinate<T> {
    /// Where it is.
    #[inline(always)]
    pub fn point(&self) -> Point<T> {
        Point { position: self.position, rate: self.rate }
    }

    /// Where it is in the middle of the sub-step.
    #[inline(always)]
    pub fn middle(&self, weights: &Weights<T>) -> Point<T> {
        let Self { position, rate, now, before } = *self;
        Point {
            position: position + weights.half * rate + weights.square_sixth * now - weights.square_24th * before,
            rate: rate + weights.three_quarters * now - weights.quarter * before,
        }
    }

    /// Goes to the end of the sub-step but for what `finish` adds; the rate that is returned is foreseen.
    #[inline(always)]
    pub fn arrive(&mut self, weights: &Weights<T>, middle: T) -> Point<T> {
        let Self { position, rate, now, before } = *self;
        let position = position + weights.whole * rate + weights.square_sixth * now + weights.square_third * middle;
        let foreseen = rate + weights.sixth * before - weights.third * now + weights.seven_sixths * middle;
        let rate = rate + weights.sixth * now + weights.two_thirds * middle;
        *self = Self { position, rate, now, before: middle };
        Point { position, rate: foreseen }
    }

    /// The acceleration at the end, for the last part of Simpson's rule and for the next sub-step.
    #[inline(always)]
    pub fn finish(&mut self, weights: &Weights<T>, last: T) {
        self.rate += weights.sixth * last;
        self.now = last;
    }
}

//! Classical fourth-order Runge-Kutta method for x'' = a(x, x', t), written for positions and rates: the stages of the
//! position need no evaluation.

use crate::gears::state::{Motion, Relative};
use crate::numbers::Real;

/// Advances by one step; calls `acceleration` at the start (node 0), twice in the middle (node 1) and at the end (node 2).
#[inline(always)]
pub fn step<T: Real, const N: usize>(
    step: T,
    motion: &Motion<T, N>,
    acceleration: impl Fn(usize, &Relative<T, N>, &Relative<T, N>) -> Relative<T, N>,
) -> Motion<T, N> {
    let Motion { position, rate } = motion;
    let half = step * T::HALF;

    let first = acceleration(0, position, rate);
    let coasted = position.plus(half, rate);
    let second = acceleration(1, &coasted, &rate.plus(half, &first));
    let third = acceleration(1, &coasted.plus(half * half, &first), &rate.plus(half, &second));
    let coasted = position.plus(step, rate);
    let fourth = acceleration(2, &coasted.plus(half * step, &second), &rate.plus(step, &third));

    let middle = second.plus(T::ONE, &third);
    let sixth = step * T::SIXTH;
    Motion {
        position: coasted.plus(step * sixth, &first.plus(T::ONE, &middle)),
        rate: rate.plus(sixth, &first.plus(T::TWO, &middle).plus(T::ONE, &fourth)),
    }
}

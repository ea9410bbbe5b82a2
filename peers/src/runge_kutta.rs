//! The classical Runge-Kutta method of order 4, in its form for second-order equations: the stages of the positions
//! need no evaluation of their own, and the last sums are formed once. Kinks inside the step are not looked for.

use model_core::real::Real;

use crate::forces::{ForceLaw, Push, acceleration};
use crate::motion::Motion;
use crate::plant::Plant;
use crate::scheme::{Nodes, Scheme};

/// The method; it carries nothing from step to step.
#[derive(Debug, Clone, Copy, Default)]
pub struct RungeKutta4;

impl<T: Real, const N: usize> Scheme<T, N> for RungeKutta4 {
    const MIDDLE: bool = true;

    #[inline(always)]
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        nodes: &Nodes<'_, T, N>,
        motion: &Motion<T, N>,
    ) -> Motion<T, N> {
        let step = plant.step;
        let half = step * T::HALF;
        let Motion { position, rate } = motion;
        let first = acceleration::<T, N, L, COMPLIANT>(plant, push, nodes.start, position, rate);
        let coasted = position.plus::<COMPLIANT>(half, rate);
        let second = acceleration::<T, N, L, COMPLIANT>(
            plant,
            push,
            nodes.middle,
            &coasted,
            &rate.plus::<COMPLIANT>(half, &first),
        );
        let third = acceleration::<T, N, L, COMPLIANT>(
            plant,
            push,
            nodes.middle,
            &coasted.plus::<COMPLIANT>(half * half, &first),
            &rate.plus::<COMPLIANT>(half, &second),
        );
        let coasted = position.plus::<COMPLIANT>(step, rate);
        let fourth = acceleration::<T, N, L, COMPLIANT>(
            plant,
            push,
            nodes.end,
            &coasted.plus::<COMPLIANT>(half * step, &second),
            &rate.plus::<COMPLIANT>(step, &third),
        );
        let middle = second.plus::<COMPLIANT>(T::ONE, &third);
        let sum = first.plus::<COMPLIANT>(T::ONE, &middle);
        let sixth = step * T::SIXTH;
        let all = sum.plus::<COMPLIANT>(T::ONE, &middle).plus::<COMPLIANT>(T::ONE, &fourth);
        Motion { position: coasted.plus::<COMPLIANT>(step * sixth, &sum), rate: rate.plus::<COMPLIANT>(sixth, &all) }
    }
}

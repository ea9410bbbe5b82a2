//! Classical Runge-Kutta method of order 4, in its form for second-order equations: the position stages need no evaluations of their own,
//! and the final sums are formed once. Kinks inside the step are not located.

use model_core::numbers::Real;

use crate::forces::{ForceLaw, Push, acceleration};
use crate::instant::{Instant, Rotor};
use crate::motion::PeerState;
use crate::plant::Plant;
use crate::scheme::{Phases, Scheme};

/// The method with the meshes at the end of the last step.
#[derive(Debug, Clone, Copy)]
pub struct RungeKutta4<T, const N: usize> {
    start: Instant<T, N>,
}

impl<T: Real, const N: usize> Scheme<T, N> for RungeKutta4<T, N> {
    const MIDDLE: bool = true;

    fn begin(plant: &Plant<T, N>, phase: &Rotor<T>) -> Self {
        Self { start: Instant::at(plant, phase) }
    }

    #[inline(always)]
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        phases: &Phases<'_, T>,
        motion: &mut PeerState<T, N>,
    ) {
        let (middle, end) = (Instant::at(plant, phases.middle), Instant::at(plant, phases.end));
        let step = plant.step;
        let half = step * T::HALF;
        let PeerState { position, rate } = motion;
        let first = acceleration::<T, N, L, COMPLIANT>(plant, push, &self.start, position, rate);
        let coasted = position.plus::<COMPLIANT>(half, rate);
        let second =
            acceleration::<T, N, L, COMPLIANT>(plant, push, &middle, &coasted, &rate.plus::<COMPLIANT>(half, &first));
        let third = acceleration::<T, N, L, COMPLIANT>(
            plant,
            push,
            &middle,
            &coasted.plus::<COMPLIANT>(half * half, &first),
            &rate.plus::<COMPLIANT>(half, &second),
        );
        let coasted = position.plus::<COMPLIANT>(step, rate);
        let fourth = acceleration::<T, N, L, COMPLIANT>(
            plant,
            push,
            &end,
            &coasted.plus::<COMPLIANT>(half * step, &second),
            &rate.plus::<COMPLIANT>(step, &third),
        );
        let both = second.plus::<COMPLIANT>(T::ONE, &third);
        let sum = first.plus::<COMPLIANT>(T::ONE, &both);
        let sixth = step * T::SIXTH;
        let all = sum.plus::<COMPLIANT>(T::ONE, &both).plus::<COMPLIANT>(T::ONE, &fourth);
        *motion = PeerState {
            position: coasted.plus::<COMPLIANT>(step * sixth, &sum),
            rate: rate.plus::<COMPLIANT>(sixth, &all),
        };
        self.start = end;
    }
}

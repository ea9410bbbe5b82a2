//! Semi-implicit Euler: the rate first, then the position by the new rate. The cheapest method that keeps its energy;
//! kinks inside the step are not looked for.

use model_core::real::Real;

use crate::forces::{ForceLaw, Push, acceleration};
use crate::motion::Motion;
use crate::plant::Plant;
use crate::scheme::{Nodes, Scheme};

/// The method; it carries nothing from step to step.
#[derive(Debug, Clone, Copy, Default)]
pub struct SemiImplicitEuler;

impl<T: Real, const N: usize> Scheme<T, N> for SemiImplicitEuler {
    const MIDDLE: bool = false;

    #[inline(always)]
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        nodes: &Nodes<'_, T, N>,
        motion: &Motion<T, N>,
    ) -> Motion<T, N> {
        let Motion { position, rate } = motion;
        let change = acceleration::<T, N, L, COMPLIANT>(plant, push, nodes.start, position, rate);
        let rate = rate.plus::<COMPLIANT>(plant.step, &change);
        Motion { position: position.plus::<COMPLIANT>(plant.step, &rate), rate }
    }
}

//! Semi-implicit Euler: the rate first, then the position with the new rate. The cheapest method that keeps its energy; kinks inside the
//! step are not located.

use model_core::numbers::Real;

use crate::forces::{ForceLaw, Push, acceleration};
use crate::instant::{Instant, Rotor};
use crate::motion::PeerState;
use crate::plant::Plant;
use crate::scheme::{Phases, Scheme};

/// The method, without state between steps.
#[derive(Debug, Clone, Copy)]
pub struct SemiImplicitEuler;

impl<T: Real, const N: usize> Scheme<T, N> for SemiImplicitEuler {
    const MIDDLE: bool = false;

    fn begin(_: &Plant<T, N>, _: &Rotor<T>) -> Self {
        Self
    }

    #[inline(always)]
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        phases: &Phases<'_, T>,
        motion: &mut PeerState<T, N>,
    ) {
        let now = Instant::at(plant, phases.start);
        let change = acceleration::<T, N, L, COMPLIANT>(plant, push, &now, &motion.position, &motion.rate);
        motion.rate = motion.rate.plus::<COMPLIANT>(plant.step, &change);
        motion.position = motion.position.plus::<COMPLIANT>(plant.step, &motion.rate);
    }
}

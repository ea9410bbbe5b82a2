//! What the way between motor and link depends on besides the teeth: offset, skew and the encoders' errors once and
//! twice a turn. Their sizes are the learner's.

use super::learner::Regressors;
use super::{MAPPED, PLAIN};
use crate::real::Real;
use crate::realtime::phase::sine_cosine;

/// Regressors with side and force left at zero; phases in 2^-32 turns. Without an output
/// encoder its own are zero.
pub(super) fn free<T: Real, const P: usize>(link_speed: T, motor: u32, output: Option<u32>) -> Regressors<T, P> {
    let mut regressors = [T::ZERO; P];
    if let [_, offset, _, skew, ..] = regressors.as_mut_slice() {
        *offset = T::ONE;
        *skew = link_speed;
    }
    if P == MAPPED {
        for (phase, places) in [Some(motor), output].into_iter().zip(regressors.chunks_exact_mut(PLAIN).skip(1)) {
            let Some(phase) = phase else { continue };
            let (sine, cosine) = sine_cosine::<T>(phase);
            let doubled = [sine, cosine, T::TWO * sine * cosine, T::ONE - T::TWO * sine * sine];
            places.copy_from_slice(&doubled);
        }
    }
    regressors
}

/// The same with teeth that touch: a side and a force.
pub(super) fn touching<T: Real, const P: usize>(free: &Regressors<T, P>, side: T, force: T) -> Regressors<T, P> {
    let mut regressors = *free;
    if let [half_gap, _, compliance, ..] = regressors.as_mut_slice() {
        *half_gap = side;
        *compliance = force;
    }
    regressors
}

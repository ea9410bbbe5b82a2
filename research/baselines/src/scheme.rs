//! The interface of a fixed-step method.

use model_core::numbers::Real;

use crate::forces::{ForceLaw, Push};
use crate::instant::Rotor;
use crate::motion::PeerState;
use crate::plant::Plant;

/// The mesh phase over a step.
pub struct Phases<'a, T> {
    /// At the start.
    pub start: &'a Rotor<T>,
    /// In the middle; of no use where the method does not want it.
    pub middle: &'a Rotor<T>,
    /// At the end.
    pub end: &'a Rotor<T>,
}

/// A fixed-step method.
pub trait Scheme<T: Real, const N: usize>: Sized {
    /// Whether it evaluates in the middle of the step.
    const MIDDLE: bool;

    /// Ready for the first step, from this phase on.
    fn begin(plant: &Plant<T, N>, phase: &Rotor<T>) -> Self;

    /// Takes torques; what was taken over from the last step may no longer hold.
    fn set_torques(&mut self, _plant: &Plant<T, N>, _push: &Push<T>) {}

    /// One step.
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        phases: &Phases<'_, T>,
        motion: &mut PeerState<T, N>,
    );
}

//! Interface of a fixed-step method.

use model_core::numbers::Real;

use crate::forces::{ForceLaw, Push};
use crate::instant::Rotor;
use crate::motion::PeerState;
use crate::plant::Plant;

/// Mesh phase over a step.
pub struct Phases<'a, T> {
    /// At the start.
    pub start: &'a Rotor<T>,
    /// In the middle; meaningless unless the method evaluates there.
    pub middle: &'a Rotor<T>,
    /// At the end.
    pub end: &'a Rotor<T>,
}

/// Fixed-step method.
pub trait Scheme<T: Real, const N: usize>: Sized {
    /// True if the method evaluates in the middle of the step.
    const MIDDLE: bool;

    /// Method before its first step, from a phase on.
    fn begin(plant: &Plant<T, N>, phase: &Rotor<T>) -> Self;

    /// Sets the torques; data kept from the last step may be invalid from then on.
    fn set_torques(&mut self, _plant: &Plant<T, N>, _push: &Push<T>) {}

    /// Advances the motion by one step.
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        phases: &Phases<'_, T>,
        motion: &mut PeerState<T, N>,
    );
}

//! What a fixed-step method has to offer to be run over the joint. The methods are in files of their own.

use model_core::real::Real;

use crate::forces::{ForceLaw, Push};
use crate::instant::Instant;
use crate::motion::Motion;
use crate::plant::Plant;

/// The meshes over a step.
pub struct Nodes<'a, T, const N: usize> {
    /// At the start.
    pub start: &'a Instant<T, N>,
    /// In the middle; the end again where the method does not want it.
    pub middle: &'a Instant<T, N>,
    /// At the end.
    pub end: &'a Instant<T, N>,
}

/// A fixed-step method.
pub trait Scheme<T: Real, const N: usize>: Default {
    /// Whether it evaluates in the middle of the step.
    const MIDDLE: bool;

    /// Forgets what it took over from the last step: the torques have changed.
    fn torques_changed(&mut self) {}

    /// One step.
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        nodes: &Nodes<'_, T, N>,
        motion: &Motion<T, N>,
    ) -> Motion<T, N>;
}

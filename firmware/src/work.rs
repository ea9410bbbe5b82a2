//! What a role does in its tick: the joint, the controller, or both, without a word about clocks, queues and safe states,
//! which are the same for all of them and are kept by `control`.

use model_core::observer::{Memory, MemoryError};
use model_core::virtual_joint::fault::{Fault, FixedPoint};

use crate::words::Words;

/// What a role does in its tick.
pub trait Work {
    /// What it says and hears.
    type Words: Words;
    /// Whether it goes on by itself while the host is silent: a simulation does; who answers to a controller does not.
    const GOES_ON: bool;

    /// Whether its tables are what they were made to be.
    fn is_sound(&self) -> bool;
    /// Back to the start of a run; from what is remembered, if that is wished for.
    fn reset(&mut self, from_memory: bool);
    /// Remembers what has been learnt so far; `false` in a role that learns nothing.
    fn learn(&mut self) -> bool {
        false
    }
    /// What is remembered.
    fn learnt(&self) -> Option<&<Self::Words as Words>::Learnt> {
        None
    }
    /// Remembers what was learnt before the board was switched on, or elsewhere.
    fn remember(&mut self, _memory: &Memory) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
    /// The same in the role's own form. Never called in a role that learns nothing: a reference to its form, which has no
    /// values, is taken by the compiler for a place that is not reached, and what would use it becomes a trap in the tick.
    fn remember_learnt(&mut self, _learnt: &<Self::Words as Words>::Learnt) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
    /// Remembers nothing any more.
    fn forget(&mut self) {}
    /// Takes the command of the step to come.
    fn take(&mut self, command: <Self::Words as Words>::Command);
    /// Takes a fault for the run to come; `false` if the role has none, or no room for another.
    fn add_fault(&mut self, _fault: Fault<FixedPoint<f32>>) -> bool {
        false
    }
    /// One step.
    fn step(&mut self);
    /// Whether the last step left numbers.
    fn is_finite(&self) -> bool;
    /// What there is to be reported after so many steps; the last one took so many timer counts so far.
    fn sample(&self, steps: u32, computation: u16) -> <Self::Words as Words>::Sample;
}

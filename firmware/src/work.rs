//! The work of a role's tick: the joint, the controller, or both. Clocks, queues and the safe state are the same for all roles
//! and are in `tick_handler`.

use model_core::observer::{Memory, MemoryError};
use model_core::virtual_joint::fault::{Fault, FixedPoint};

use crate::protocol::Protocol;

/// The work of a role's tick.
pub trait Work {
    /// Its messages.
    type Protocol: Protocol;
    /// Whether it runs on while the host is silent: a simulation does; a role that answers a controller does not.
    const FREE_RUNNING: bool;

    /// Whether its tables match their digest.
    fn is_sound(&self) -> bool;
    /// Back to the start of a run; from the memory at hand, if that is requested.
    fn reset(&mut self, from_memory: bool);
    /// Copies what has been learnt so far into the memory at hand; `false` in a role that learns nothing.
    fn learn(&mut self) -> bool {
        false
    }
    /// The memory at hand.
    fn learnt(&self) -> Option<&<Self::Protocol as Protocol>::Learnt> {
        None
    }
    /// Takes a memory from flash or from the host as the one at hand, if it is valid.
    fn remember(&mut self, _memory: &Memory) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
    /// The same in the role's own form. Never called in a role that learns nothing: a reference to its form, which has no
    /// values, is taken by the compiler for a place that is not reached, and what would use it becomes a trap in the tick.
    fn remember_learnt(&mut self, _learnt: &<Self::Protocol as Protocol>::Learnt) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
    /// Discards the memory at hand.
    fn forget(&mut self) {}
    /// Takes the command of the step to come.
    fn take(&mut self, command: <Self::Protocol as Protocol>::Command);
    /// Takes a fault for the run to come; `false` if the role has none, or no room for another.
    fn add_fault(&mut self, _fault: Fault<FixedPoint<f32>>) -> bool {
        false
    }
    /// One step.
    fn step(&mut self);
    /// Whether the last step left numbers.
    fn is_finite(&self) -> bool;
    /// What there is to be reported after so many steps; the last one took so many timer counts so far.
    fn sample(&self, steps: u32, computation: u16) -> <Self::Protocol as Protocol>::Sample;
}

//! Work of a role's tick: the joint, the controller, or both. Clocks, queues and safe state are common to all roles and
//! are in `tick_handler`.

use model_core::observer::{Memory, MemoryError};
use model_core::virtual_joint::fault::{Fault, FixedPoint};

use crate::protocol::Protocol;

/// Work of a role's tick.
pub trait Work {
    /// Messages of the role.
    type Protocol: Protocol;
    /// `true` if the role steps on while the host is silent, as a simulation does; a role that answers a controller
    /// does not.
    const FREE_RUNNING: bool;

    /// Returns `true` if the tables match their digest.
    fn is_sound(&self) -> bool;
    /// Resets to the start of a run; loads the memory at hand (the saved parameters) if requested.
    fn reset(&mut self, from_memory: bool);
    /// Copies the estimated parameters into the memory at hand; `false` in a role that estimates none.
    fn learn(&mut self) -> bool {
        false
    }
    /// The memory at hand.
    fn learnt(&self) -> Option<&<Self::Protocol as Protocol>::Learnt> {
        None
    }
    /// Makes a memory from flash or from the host the memory at hand, if it is valid.
    fn remember(&mut self, _memory: &Memory) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
    /// Makes a memory in the role's own form the memory at hand. Never called in a role without memory: its form has no
    /// values, so the compiler treats a reference to it as unreachable and would put a trap into the tick.
    fn remember_learnt(&mut self, _learnt: &<Self::Protocol as Protocol>::Learnt) -> Result<(), MemoryError> {
        Err(MemoryError::OtherJoint)
    }
    /// Discards the memory at hand.
    fn forget(&mut self) {}
    /// Takes the command for the next step.
    fn take(&mut self, command: <Self::Protocol as Protocol>::Command);
    /// Adds a fault to the next run; `false` if the role has no faults or no room for another.
    fn add_fault(&mut self, _fault: Fault<FixedPoint<f32>>) -> bool {
        false
    }
    /// Advances by one step.
    fn step(&mut self);
    /// Returns `true` if the state is finite after the last step.
    fn is_finite(&self) -> bool;
    /// Sample to report after `steps` steps; `computation` is the time of the last step [timer counts].
    fn sample(&self, steps: u32, computation: u16) -> <Self::Protocol as Protocol>::Sample;
}

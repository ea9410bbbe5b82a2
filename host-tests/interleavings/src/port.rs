//! Port to a controller that `learnt` needs. No model has a role with a memory, so nothing implements it.

use model_core::observer::{Memory, MemoryError};

/// Part of the firmware's ports that transfers a memory.
pub trait ControllerPort {
    /// Copies the estimated parameters; returns `false` if there are none.
    fn memory(&self, memory: &mut Memory) -> bool;
    /// Loads parameters estimated earlier.
    fn recall(&mut self, memory: &Memory) -> Result<(), MemoryError>;
}

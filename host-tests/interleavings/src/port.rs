//! What `learnt` asks of a port to a controller. No model has a role that learns: nobody implements it.

use model_core::observer::{Memory, MemoryError};

/// Of the firmware's ports, what a memory goes through.
pub trait ControllerPort {
    /// Copies what was learnt; `false` if there is nothing.
    fn memory(&self, memory: &mut Memory) -> bool;
    /// Takes what was learnt earlier.
    fn recall(&mut self, memory: &Memory) -> Result<(), MemoryError>;
}

//! Estimated parameters (memory) between runs of a role. A role without estimator has no memory; otherwise a run may
//! begin from the memory at hand. `kept_memory` stores it in flash.

use core::convert::Infallible;

use link::messages::MemoryState;
use model_core::observer::{MEMORY_BYTES, Memory, MemoryError};

use crate::port::ControllerPort;

/// Memory of a role; a role without estimator needs no room for it.
pub trait Learnt: Clone {
    /// Empty memory; `None` in a role without estimator.
    const EMPTY: Option<Self>;
    /// Bytes of the memory.
    fn memory(&self) -> &Memory;
    /// Bytes of the memory, mutable.
    fn memory_mut(&mut self) -> &mut Memory;
}

impl Learnt for Memory {
    const EMPTY: Option<Self> = Some([0; MEMORY_BYTES]);

    fn memory(&self) -> &Memory {
        self
    }

    fn memory_mut(&mut self) -> &mut Memory {
        self
    }
}

impl Learnt for Infallible {
    const EMPTY: Option<Self> = None;

    fn memory(&self) -> &Memory {
        match *self {}
    }

    fn memory_mut(&mut self) -> &mut Memory {
        match *self {}
    }
}

/// Wire form of a memory check; `None` stands for no memory.
pub fn memory_state(judged: Option<Result<(), MemoryError>>) -> MemoryState {
    match judged {
        None => MemoryState::Nothing,
        Some(Ok(())) => MemoryState::Good,
        Some(Err(MemoryError::NotAMemory)) => MemoryState::NotAMemory,
        Some(Err(MemoryError::WrongVersion)) => MemoryState::WrongVersion,
        Some(Err(MemoryError::Damaged)) => MemoryState::Damaged,
        Some(Err(MemoryError::OtherJoint)) => MemoryState::OtherJoint,
        Some(Err(MemoryError::OutOfRange)) => MemoryState::OutOfRange,
    }
}

/// Memory at hand, from which runs may begin.
#[derive(Debug, Clone)]
pub struct RunMemory {
    memory: Memory,
    /// The memory is valid.
    good: bool,
}

impl Default for RunMemory {
    fn default() -> Self {
        Self { memory: [0; MEMORY_BYTES], good: false }
    }
}

impl RunMemory {
    /// Copies a controller's estimated parameters; `false` if the port cannot provide them.
    #[inline(never)]
    pub fn learn_from(&mut self, port: &impl ControllerPort) -> bool {
        let learnt = port.memory(&mut self.memory);
        self.good |= learnt;
        learnt
    }

    /// Returns the memory, if it is valid.
    pub fn get(&self) -> Option<&Memory> {
        self.good.then_some(&self.memory)
    }

    /// Takes a memory if the controller accepts it.
    pub fn take(&mut self, memory: &Memory, port: &mut impl ControllerPort) -> Result<(), MemoryError> {
        port.recall(memory)?;
        self.memory = *memory;
        self.good = true;
        Ok(())
    }

    /// Discards the memory.
    pub fn forget(&mut self) {
        self.good = false;
    }

    /// Loads the memory into a controller after a reset.
    pub fn load_into(&self, port: &mut impl ControllerPort) {
        if self.good {
            // The memory was checked when it was taken.
            let _ = port.recall(&self.memory);
        }
    }
}

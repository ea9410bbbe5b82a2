//! What an observer has learnt, between runs of a role: none where nothing is learnt, at hand where a run may begin from it.
//! Where it outlives a reset is in `kept_memory`.

use core::convert::Infallible;

use link::messages::MemoryState;
use model_core::observer::{MEMORY_BYTES, Memory, MemoryError};

use crate::port::ControllerPort;

/// The memory of a role that learns; a role that learns nothing takes no room for it.
pub trait Learnt: Clone {
    /// Room for one; none where nothing is learnt.
    const EMPTY: Option<Self>;
    /// The memory's bytes.
    fn memory(&self) -> &Memory;
    /// The same, to be changed.
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

/// The wire's form of the result of a check.
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

/// The memory at hand, from which runs may begin.
#[derive(Debug, Clone)]
pub struct RunMemory {
    memory: Memory,
    /// It holds a valid memory.
    good: bool,
}

impl Default for RunMemory {
    fn default() -> Self {
        Self { memory: [0; MEMORY_BYTES], good: false }
    }
}

impl RunMemory {
    /// Copies what a controller has learnt; `false` where the port cannot provide it.
    #[inline(never)]
    pub fn learn_from(&mut self, port: &impl ControllerPort) -> bool {
        let learnt = port.memory(&mut self.memory);
        self.good |= learnt;
        learnt
    }

    /// The memory, if there is one.
    pub fn get(&self) -> Option<&Memory> {
        self.good.then_some(&self.memory)
    }

    /// Takes a memory that the controller finds good.
    pub fn take(&mut self, memory: &Memory, port: &mut impl ControllerPort) -> Result<(), MemoryError> {
        port.recall(memory)?;
        self.memory = *memory;
        self.good = true;
        Ok(())
    }

    /// Discards it.
    pub fn forget(&mut self) {
        self.good = false;
    }

    /// Loads it into a controller that was reset.
    pub fn give(&self, port: &mut impl ControllerPort) {
        if self.good {
            // It was found good when it was taken.
            let _ = port.recall(&self.memory);
        }
    }
}

//! Where what an observer has learnt outlives a reset: one page of flash, read at start, written and erased between
//! runs. What is read there is checked before it is used.

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

/// A place for one memory.
pub trait Page {
    /// What is there.
    fn read(&self) -> Memory;

    /// Erases and writes it. May hold everything up for a second or two.
    fn write(&mut self, memory: &Memory);
}

/// What a page holds; nothing if it is empty, as after an erase, or where there is no flash at all.
pub fn recall(page: &impl Page) -> Option<Memory> {
    let memory = page.read();
    let empty = [0xff, 0].into_iter().any(|level| memory.iter().all(|byte| *byte == level));
    (!empty).then_some(memory)
}

/// Writes a memory; returns whether it reads back as written.
pub fn keep(page: &mut impl Page, memory: &Memory) -> bool {
    // What is there already is not worn out by writing it again.
    if page.read() != *memory {
        page.write(memory);
    }
    page.read() == *memory
}

/// Erases it; returns whether it reads back as empty.
pub fn erase(page: &mut impl Page) -> bool {
    // One that is empty is not worn out by erasing it again.
    if recall(page).is_some() {
        page.write(&[0xff; MEMORY_BYTES]);
    }
    recall(page).is_none()
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

// Whole words of every board's flash, of up to 32 bytes.
const _: () = assert!(MEMORY_BYTES.is_multiple_of(32));

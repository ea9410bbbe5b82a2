//! Memory of a controller's estimated parameters, exchanged between board and host between runs: saved in the board's
//! flash, read, loaded and erased.

use heapless::Vec;
use model_core::observer::MEMORY_BYTES;
use serde::{Deserialize, Serialize};

/// Frames that carry one memory.
pub const MEMORY_PARTS: u8 = 2;
/// Bytes per frame.
pub const PART_BYTES: usize = MEMORY_BYTES / MEMORY_PARTS as usize;

/// Memory request. A request that cannot be carried out is answered by
/// [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome) with the reason.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum MemoryRequest {
    /// Save the controller's estimated parameters to flash. Answered by
    /// [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome).
    Save,
    /// Read a part of the flash content. Answered by [`FromBoard::Memory`](super::FromBoard::Memory).
    Read {
        /// Number of the part, from 0.
        part: u8,
    },
    /// Load a part of a memory from which runs may begin. The last part is answered by
    /// [`FromBoard::MemoryChecked`](super::FromBoard::MemoryChecked) once the controller has checked the whole memory.
    Load(MemoryPart),
    /// Write the last loaded memory to flash, if it is valid. Answered by
    /// [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome).
    Write,
    /// Discard the memory, also in flash. Answered by [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome).
    Erase,
}

/// Part of a memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MemoryPart {
    /// Number of the part, from 0 to one less than [`MEMORY_PARTS`].
    pub part: u8,
    /// Bytes of the part, [`PART_BYTES`] long.
    pub bytes: Vec<u8, PART_BYTES>,
}

/// Validity of a memory found in flash or loaded by the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MemoryState {
    /// No memory: the role estimates no parameters, or none were saved yet.
    Nothing,
    /// Valid memory: runs may begin from it.
    Good,
    /// Content that was never a memory.
    NotAMemory,
    /// Memory of another version.
    WrongVersion,
    /// Damaged memory.
    Damaged,
    /// Memory of another joint or of other encoders.
    OtherJoint,
    /// Memory with a value that is not finite or impossible for the joint's design.
    OutOfRange,
}

/// Outcome of a memory request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MemoryOutcome {
    /// The memory is in flash and was verified by reading back.
    Stored,
    /// There is no memory: the role estimates no parameters, or no valid memory was loaded.
    Nothing,
    /// A run goes on: stop it first, since a flash write may block the board for a second.
    Running,
    /// Verification failed: there is no such flash, or it is worn.
    NotWritten,
    /// The supply voltage is too low to write flash; nothing was changed.
    LowSupply,
}

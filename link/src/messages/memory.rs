//! The memory of what a controller has learnt, on its way between a board and its host: saved in the board's
//! flash, read, loaded and erased between runs.

use heapless::Vec;
use model_core::observer::MEMORY_BYTES;
use serde::{Deserialize, Serialize};

/// Frames that carry one memory.
pub const MEMORY_PARTS: u8 = 2;
/// Bytes in each of them.
pub const PART_BYTES: usize = MEMORY_BYTES / MEMORY_PARTS as usize;

/// A request about the memory. One that cannot be done is answered by
/// [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome) with the reason.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum MemoryRequest {
    /// Save what the controller has learnt to flash. Answered by
    /// [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome).
    Save,
    /// Read a part of what the flash page holds. Answered by [`FromBoard::Memory`](super::FromBoard::Memory).
    Read {
        /// Number of the part, from 0.
        part: u8,
    },
    /// Load a part of a memory for runs that begin from one. The last part is answered by
    /// [`FromBoard::MemoryChecked`](super::FromBoard::MemoryChecked), once the controller has checked the whole.
    Load(MemoryPart),
    /// Write the memory that was loaded last, and found good, to flash. Answered by
    /// [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome).
    Write,
    /// Discard it, in flash too. Answered by [`FromBoard::MemoryOutcome`](super::FromBoard::MemoryOutcome).
    Erase,
}

/// A part of a memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MemoryPart {
    /// Its number, from 0 to one less than [`MEMORY_PARTS`].
    pub part: u8,
    /// Its bytes: [`PART_BYTES`] of them.
    pub bytes: Vec<u8, PART_BYTES>,
}

/// Validity of the memory that a board has found in flash or was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MemoryState {
    /// None: the role learns nothing, or nothing was saved yet.
    Nothing,
    /// Valid: runs may begin from it.
    Good,
    /// Something that was never a memory.
    NotAMemory,
    /// A memory of another version.
    WrongVersion,
    /// A memory of which some was lost.
    Damaged,
    /// A memory of another joint or of other encoders.
    OtherJoint,
    /// A memory with a number that is none, or that no joint of its design can have.
    OutOfRange,
}

/// Outcome of a request about the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MemoryOutcome {
    /// It is in flash, and reads as it was written.
    Stored,
    /// There is nothing to save: the role learns nothing, or no valid memory was loaded.
    Nothing,
    /// A run goes on: stop it first, since writing flash may hold the board up for a second.
    Running,
    /// It does not read as it was written: there is no such flash, or it is worn.
    NotWritten,
    /// The supply is too low to write flash: nothing was changed.
    LowSupply,
}

//! What a controller has learnt, on its way between a board and its host: kept in a page of the board's flash, told,
//! taken and erased between runs.

use heapless::Vec;
use model_core::observer::MEMORY_BYTES;
use serde::{Deserialize, Serialize};

/// Frames that carry one memory.
pub const MEMORY_PARTS: u8 = 2;
/// Bytes in each of them.
pub const PART_BYTES: usize = MEMORY_BYTES / MEMORY_PARTS as usize;

/// What a host wants of a memory. Answered by [`FromBoard::Kept`](super::FromBoard::Kept) with why if nothing comes of it.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum MemoryWish {
    /// Keep what the controller has learnt, in flash. Answered by [`FromBoard::Kept`](super::FromBoard::Kept).
    Keep,
    /// Tell a part of what the page holds. Answered by [`FromBoard::Memory`](super::FromBoard::Memory).
    Tell {
        /// Number of the part, from 0.
        part: u8,
    },
    /// A part of a memory for runs that begin from one. The last part is answered by
    /// [`FromBoard::Judged`](super::FromBoard::Judged), once the controller has looked at the whole.
    Take(MemoryPart),
    /// Write the memory that was taken last, and found good, to flash. Answered by [`FromBoard::Kept`](super::FromBoard::Kept).
    Write,
    /// Forget it, in flash too. Answered by [`FromBoard::Kept`](super::FromBoard::Kept).
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

/// What a board found where it keeps what its controller has learnt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Remembered {
    /// Nothing: its role learns nothing, or nothing was kept yet.
    Nothing,
    /// What can be gone on from.
    Good,
    /// Something that was never a memory.
    NotAMemory,
    /// A memory of another version.
    WrongVersion,
    /// A memory of which some was lost.
    Damaged,
    /// A memory of another joint or of other encoders.
    OtherJoint,
    /// A memory with a number that is none.
    NotFinite,
}

/// What became of what was to be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kept {
    /// It is in flash, and reads as it was written.
    Stored,
    /// There is nothing to keep: the role learns nothing, or no memory that was taken is good.
    Nothing,
    /// A run goes on: stop it first, since writing flash may hold the board up for a second.
    Running,
    /// It does not read as it was written: there is no such flash, or it is worn.
    NotWritten,
}

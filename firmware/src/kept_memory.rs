//! Storage of the estimated parameters (memory) that survives a reset, and a power cut at any moment: two slots of
//! flash. A memory is written into the slot without the newest record; its trailer (sequence number and checksum) is
//! written last. Until the trailer is complete, the old record is the newest. To erase, a newer record without content
//! is written.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use link::messages::MemoryOutcome;
use model_core::observer::{MEMORY_BYTES, Memory};

/// Bytes of a trailer: a multiple of the write unit of every board's flash.
const TRAILER: usize = 32;
/// Bytes of a record.
pub const RECORD_BYTES: usize = MEMORY_BYTES + TRAILER;
/// Memory and trailer: sequence number and checksum over both, little-endian; the rest is as erased.
pub type Record = [u8; RECORD_BYTES];

// Multiple of the write unit of every board's flash, up to 32 bytes.
const _: () = assert!(RECORD_BYTES.is_multiple_of(32));

static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Content of an erased memory.
pub const NOTHING: Memory = [0xff; MEMORY_BYTES];

/// Slot of flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// First slot.
    A,
    /// Second slot.
    B,
}

impl Slot {
    const BOTH: [Self; 2] = [Self::A, Self::B];

    /// Index, 0 or 1.
    pub fn index(self) -> usize {
        self as usize
    }

    fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// Flash with room for two records. Erasing or writing a slot leaves the other slot unchanged; each operation may block
/// the core for up to two seconds.
pub trait Slots {
    /// Returns the content of a slot; `None` if it cannot be read, as after a power cut during a write.
    fn read(&mut self, slot: Slot) -> Option<Record>;

    /// Erases a slot.
    fn erase(&mut self, slot: Slot);

    /// Writes an erased slot, in the order of the bytes.
    fn write(&mut self, slot: Slot, record: &Record);

    /// Returns `true` if the supply voltage suffices for writing.
    fn has_supply(&mut self) -> bool;
}

/// Content found in a slot.
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
enum Content {
    Empty,
    Damaged,
    Kept(u32, Memory),
}

/// Storage with the newest of two records.
pub struct KeptMemory<S> {
    slots: S,
    /// Slot and sequence number of the newest complete record.
    newest: Option<(Slot, u32)>,
}

impl<S: Slots> KeptMemory<S> {
    /// Finds the newest record.
    pub fn open(slots: S) -> Self {
        let mut kept = Self { slots, newest: None };
        for slot in Slot::BOTH {
            if let Content::Kept(sequence, _) = kept.content(slot)
                && kept.newest.is_none_or(|(_, newest)| follows(sequence, newest))
            {
                kept.newest = Some((slot, sequence));
            }
        }
        kept
    }

    /// Returns the memory; `None` if none is stored or the board has no flash.
    pub fn load(&mut self) -> Option<Memory> {
        let (slot, _) = self.newest?;
        match self.content(slot) {
            Content::Kept(_, memory) if memory != NOTHING => Some(memory),
            _ => None,
        }
    }

    /// Returns `true` if no record is complete, but a slot holds remains of a record.
    pub fn is_damaged(&mut self) -> bool {
        self.newest.is_none() && Slot::BOTH.into_iter().any(|slot| matches!(self.content(slot), Content::Damaged))
    }

    /// Stores a memory; an unchanged memory is not written again, to spare the flash.
    pub fn store(&mut self, memory: &Memory) -> MemoryOutcome {
        if self.load().as_ref() == Some(memory) { MemoryOutcome::Stored } else { self.write_record(memory) }
    }

    /// Erases the memory; an empty storage is not written again.
    pub fn erase(&mut self) -> MemoryOutcome {
        if self.load().is_none() && !self.is_damaged() {
            return MemoryOutcome::Stored;
        }
        let outcome = self.write_record(&NOTHING);
        if let (MemoryOutcome::Stored, Some((newest, _))) = (outcome, self.newest) {
            self.slots.erase(newest.other());
        }
        outcome
    }

    /// Writes a newer record into the other slot and reads it back.
    #[inline(never)]
    fn write_record(&mut self, memory: &Memory) -> MemoryOutcome {
        if !self.slots.has_supply() {
            return MemoryOutcome::LowSupply;
        }
        let (slot, sequence) = match self.newest {
            Some((newest, sequence)) => (newest.other(), sequence.wrapping_add(1)),
            None => (Slot::A, 1),
        };
        self.slots.erase(slot);
        self.slots.write(slot, &record(memory, sequence));
        match self.content(slot) {
            Content::Kept(found, written) if (found, &written) == (sequence, memory) => {
                self.newest = Some((slot, sequence));
                MemoryOutcome::Stored
            }
            _ => MemoryOutcome::NotWritten,
        }
    }

    #[inline(never)]
    fn content(&mut self, slot: Slot) -> Content {
        let Some(record) = self.slots.read(slot) else { return Content::Damaged };
        // Erased flash, or no flash at all.
        if [0xff, 0].into_iter().any(|level| record.iter().all(|byte| *byte == level)) {
            return Content::Empty;
        }
        let mut memory = NOTHING;
        let mut trailer = [0; TRAILER];
        let (content, end) = record.split_at(MEMORY_BYTES);
        memory.copy_from_slice(content);
        trailer.copy_from_slice(end);
        let ([sequence, ..], _) = trailer.as_chunks::<4>() else { return Content::Damaged };
        let sequence = u32::from_le_bytes(*sequence);
        if record == self::record(&memory, sequence) { Content::Kept(sequence, memory) } else { Content::Damaged }
    }
}

/// Record of a memory and its trailer.
fn record(memory: &Memory, sequence: u32) -> Record {
    let mut digest = CRC.digest();
    digest.update(memory);
    digest.update(&sequence.to_le_bytes());
    let mut record = [0xff; RECORD_BYTES];
    let trailer = sequence.to_le_bytes().into_iter().chain(digest.finalize().to_le_bytes());
    for (place, byte) in record.iter_mut().zip(memory.iter().copied().chain(trailer)) {
        *place = byte;
    }
    record
}

/// Returns `true` if `sequence` is newer than `other`; sequence numbers wrap.
fn follows(sequence: u32, other: u32) -> bool {
    sequence.wrapping_sub(other).cast_signed() > 0
}

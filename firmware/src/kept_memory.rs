//! Where what an observer has learnt outlives a reset, and a power cut at any moment: two slots of flash. A memory is written
//! into the slot that the newest record is not in, and its trailer, sequence number and checksum, last: until the trailer is
//! whole, the record before it is the newest. What is forgotten is overwritten by a newer record of nothing.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use link::messages::MemoryOutcome;
use model_core::observer::{MEMORY_BYTES, Memory};

/// Bytes of a trailer: what every board's flash writes at a time, or a multiple of it.
const TRAILER: usize = 32;
/// Bytes of a record.
pub const RECORD_BYTES: usize = MEMORY_BYTES + TRAILER;
/// A memory and its trailer: sequence number and checksum over both, little-endian, the rest as after an erase.
pub type Record = [u8; RECORD_BYTES];

// Whole words of every board's flash, of up to 32 bytes.
const _: () = assert!(RECORD_BYTES.is_multiple_of(32));

static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// What a memory reads as where nothing is kept: flash after an erase.
pub const NOTHING: Memory = [0xff; MEMORY_BYTES];

/// One of the two places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// The first.
    A,
    /// The second.
    B,
}

impl Slot {
    const BOTH: [Self; 2] = [Self::A, Self::B];

    /// Its place in a list of two.
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

/// Flash with room for two records. Erasing or writing one leaves the other as it is; each may hold everything up for a second
/// or two.
pub trait Slots {
    /// What a slot holds; `None` where it cannot be read, as after power was cut while it was written.
    fn read(&mut self, slot: Slot) -> Option<Record>;

    /// Erases a slot.
    fn erase(&mut self, slot: Slot);

    /// Writes a slot that was erased, from the first byte on.
    fn write(&mut self, slot: Slot, record: &Record);

    /// The supply is high enough to write.
    fn has_supply(&mut self) -> bool;
}

/// What a slot was found to hold.
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
enum Content {
    Empty,
    Damaged,
    Kept(u32, Memory),
}

/// The newest of two records.
pub struct KeptMemory<S> {
    slots: S,
    /// Slot and sequence number of the newest record that is whole.
    newest: Option<(Slot, u32)>,
}

impl<S: Slots> KeptMemory<S> {
    /// Looks for the newest record.
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

    /// The memory; `None` if there is none, as after an erase, or where there is no flash at all.
    pub fn recall(&mut self) -> Option<Memory> {
        let (slot, _) = self.newest?;
        match self.content(slot) {
            Content::Kept(_, memory) if memory != NOTHING => Some(memory),
            _ => None,
        }
    }

    /// There is no whole record, but something that may have been one.
    pub fn is_damaged(&mut self) -> bool {
        self.newest.is_none() && Slot::BOTH.into_iter().any(|slot| matches!(self.content(slot), Content::Damaged))
    }

    /// Keeps a memory; what is kept already does not wear the flash again.
    pub fn keep(&mut self, memory: &Memory) -> MemoryOutcome {
        if self.recall().as_ref() == Some(memory) { MemoryOutcome::Stored } else { self.put(memory) }
    }

    /// Forgets it; what is empty already is not worn again.
    pub fn erase(&mut self) -> MemoryOutcome {
        if self.recall().is_none() && !self.is_damaged() {
            return MemoryOutcome::Stored;
        }
        let outcome = self.put(&NOTHING);
        if let (MemoryOutcome::Stored, Some((newest, _))) = (outcome, self.newest) {
            self.slots.erase(newest.other());
        }
        outcome
    }

    /// Writes a newer record beside the newest, and reads it back.
    #[inline(never)]
    fn put(&mut self, memory: &Memory) -> MemoryOutcome {
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
        // Flash after an erase, or none at all.
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

/// A memory with its trailer.
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

/// Whether a sequence number is newer than another; they wrap.
fn follows(sequence: u32, other: u32) -> bool {
    sequence.wrapping_sub(other).cast_signed() > 0
}

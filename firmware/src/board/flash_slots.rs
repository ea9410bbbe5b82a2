//! Two slots of a board's flash: unlocked, erased, written word by word and locked again, with bounded waits. Each
//! board's file defines their location and the controller's registers. Reading back verifies the result and detects a
//! board without flash, such as the emulated board.
//!
//! After a power cut during a write, a slot may hold unreadable words, which the core reports by a fault. Each board's
//! file defines a safe way to read. If a fault ends the program nevertheless, a mark in memory that a reset does not
//! clear names the slot, and the next start skips this slot: a board always starts.

use core::ptr::{read_volatile, write_volatile};

use cortex_m::asm::{dsb, isb};

use super::bounded_wait::wait_longer;
use crate::kept_memory::{RECORD_BYTES, Record, Slot, Slots};

/// Keys of every family.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
/// Bytes of a word.
const WORD: usize = 4;

/// The flash controller of a board.
pub trait Flash {
    /// Addresses of the slots, outside the image's memory.
    const SLOTS: [usize; 2];
    /// Number of words written at a time.
    const TOGETHER: usize;
    /// Returns `true` if the registers are locked.
    fn is_locked(&self) -> bool;
    /// Writes one of the keys that unlock the registers.
    fn write_key(&mut self, key: u32);
    /// Clears errors and prepares for the next erase or write.
    fn prepare(&mut self);
    /// Starts to erase a slot.
    fn erase(&mut self, slot: Slot);
    /// Enables or disables writes.
    fn set_write_enable(&mut self, on: bool);
    /// Returns `true` while an operation is in progress.
    fn is_busy(&self) -> bool;
    /// Locks the registers and invalidates caches.
    fn lock(&mut self);
    /// Reads words that may be damaged; returns `true` if all were readable.
    fn read(&mut self, words: &mut dyn FnMut()) -> bool;
    /// Returns `true` if the supply voltage suffices for writing.
    fn has_supply(&mut self) -> bool;
}

/// Slots of a flash controller.
pub struct FlashSlots<F> {
    flash: F,
    /// Slot whose read ended the program before this start.
    left_alone: Option<Slot>,
}

impl<F: Flash> FlashSlots<F> {
    /// Slots of a controller.
    pub fn new(flash: F) -> Self {
        Self { flash, left_alone: mark::take() }
    }

    fn is_done(&self) -> bool {
        wait_longer(|| !self.flash.is_busy())
    }

    /// Runs a change with unlocked registers.
    fn open(&mut self, change: impl FnOnce(&mut Self)) {
        // Writing keys to unlocked registers would lock them until the next reset.
        if self.flash.is_locked() {
            KEYS.into_iter().for_each(|key| self.flash.write_key(key));
        }
        self.flash.prepare();
        change(self);
        self.flash.lock();
    }
}

impl<F: Flash> Slots for FlashSlots<F> {
    fn read(&mut self, slot: Slot) -> Option<Record> {
        if self.left_alone == Some(slot) {
            return None;
        }
        let mut record = [0; RECORD_BYTES];
        let first = F::SLOTS[slot.index()] as *const u32;
        mark::set(slot);
        let mut is_whole = true;
        for (index, bytes) in record.chunks_exact_mut(F::TOGETHER * WORD).enumerate() {
            is_whole &= self.flash.read(&mut || {
                for (word, bytes) in bytes.chunks_exact_mut(WORD).enumerate() {
                    // SAFETY: the slot is flash, aligned, and longer than a record.
                    let word = unsafe { read_volatile(first.add(index * F::TOGETHER + word)) };
                    bytes.copy_from_slice(&word.to_le_bytes());
                }
            });
        }
        mark::take();
        is_whole.then_some(record)
    }

    fn erase(&mut self, slot: Slot) {
        self.open(|slots| {
            slots.flash.erase(slot);
            // A timeout is found by reading back.
            let _ = slots.is_done();
        });
        if self.left_alone == Some(slot) {
            self.left_alone = None;
        }
    }

    fn write(&mut self, slot: Slot, record: &Record) {
        self.open(|slots| {
            slots.flash.set_write_enable(true);
            // Writes must be enabled before the first word.
            dsb();
            isb();
            let first = F::SLOTS[slot.index()] as *mut u32;
            for (index, bytes) in record.chunks_exact(WORD).enumerate() {
                let word = bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
                // SAFETY: within the slot, which nothing else uses; the controller has been told to take it.
                unsafe { write_volatile(first.add(index), word) };
                if (index + 1).is_multiple_of(F::TOGETHER) {
                    // A pending store has not set the busy flag yet.
                    dsb();
                    if !slots.is_done() {
                        break;
                    }
                }
            }
            slots.flash.set_write_enable(false);
        });
    }

    fn has_supply(&mut self) -> bool {
        self.flash.has_supply()
    }
}

// A record is a multiple of every board's write unit, up to eight words.
const _: () = assert!(RECORD_BYTES.is_multiple_of(8 * WORD));

/// Mark of the slot being read, in memory that a reset does not clear.
pub mod mark {
    use core::cell::UnsafeCell;
    use core::mem::MaybeUninit;

    use crate::kept_memory::Slot;

    /// "slot", little-endian, and its complement beside the slot's number: memory after power-up is neither.
    const MAGIC: u32 = 0x746f_6c73;

    struct Mark(UnsafeCell<MaybeUninit<[u32; 2]>>);

    // SAFETY: changed in init and idle only, which never run at the same time; an exception only looks.
    unsafe impl Sync for Mark {}

    #[unsafe(link_section = ".uninit.slot_mark")]
    static MARK: Mark = Mark(UnsafeCell::new(MaybeUninit::uninit()));

    fn word(slot: Slot) -> u32 {
        MAGIC ^ slot.index() as u32
    }

    /// Returns the slot being read, now or when the program ended.
    pub fn slot() -> Option<Slot> {
        // SAFETY: every bit pattern is words; volatile, since they are what the memory held at reset.
        let [mark, complement] = unsafe { MARK.0.get().cast::<[u32; 2]>().read_volatile() };
        [Slot::A, Slot::B].into_iter().find(|slot| mark == word(*slot) && complement == !mark)
    }

    /// Marks a slot as being read.
    pub(super) fn set(slot: Slot) {
        // SAFETY: there is no other user.
        unsafe { MARK.0.get().cast::<[u32; 2]>().write_volatile([word(slot), !word(slot)]) };
    }

    /// Returns the marked slot and clears the mark.
    pub(super) fn take() -> Option<Slot> {
        let slot = slot();
        // SAFETY: there is no other user.
        unsafe { MARK.0.get().cast::<[u32; 2]>().write_volatile([0; 2]) };
        slot
    }
}

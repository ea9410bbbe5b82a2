//! Flash controller common to STM32F4 and STM32G4: one control register, one status register, caches. Each chip defines
//! the slots, their erase and the write unit.

use super::flash_slots::Flash;
use super::pac::FLASH;
use crate::kept_memory::Slot;

/// Differences between chips.
pub trait Kind {
    /// Addresses of the slots.
    const SLOTS: [usize; 2];
    /// Number of words written at a time.
    const TOGETHER: usize;
    /// Error flags, cleared by ones.
    const ERRORS: u32;
    /// Size bits of a write in the control register.
    const SIZE: u32;
    /// Control bits that erase a slot, without the start bit.
    fn erase(&self, slot: Slot) -> u32;
    /// Reads words that may be damaged; returns `true` if all were readable.
    fn read(&self, words: &mut dyn FnMut()) -> bool;
    /// Returns `true` if the supply voltage suffices for writing.
    fn has_supply(&self) -> bool;
}

/// Start of an erase in the control register; busy flag in the status register.
const AT_IT: u32 = 1 << 16;
/// Write enable.
const PROGRAM: u32 = 1;
/// Lock.
const LOCK: u32 = 1 << 31;

/// Flash controller of a type of chip.
pub struct FlashUnit<K> {
    registers: FLASH,
    kind: K,
}

impl<K: Kind> FlashUnit<K> {
    /// Controller of a board.
    pub fn new(registers: FLASH, kind: K) -> Self {
        Self { registers, kind }
    }

    fn control(&mut self, bits: u32) {
        // SAFETY: erases slots only, which have no other user; all other bits do nothing without an erase.
        self.registers.cr().write(|w| unsafe { w.bits(bits) });
    }
}

impl<K: Kind> Flash for FlashUnit<K> {
    const SLOTS: [usize; 2] = K::SLOTS;
    const TOGETHER: usize = K::TOGETHER;

    fn is_locked(&self) -> bool {
        self.registers.cr().read().bits() & LOCK != 0
    }

    fn write_key(&mut self, key: u32) {
        // SAFETY: the key register takes every word.
        self.registers.keyr().write(|w| unsafe { w.bits(key) });
    }

    fn prepare(&mut self) {
        // Reads during an operation of the other bank would corrupt the data cache of STM32G4 (errata sheet ES0430,
        // 2.2.2).
        self.registers.acr().modify(|_, w| w.dcen().clear_bit());
        // SAFETY: ones clear the flags of errors.
        self.registers.sr().write(|w| unsafe { w.bits(K::ERRORS) });
    }

    fn erase(&mut self, slot: Slot) {
        let erase = self.kind.erase(slot) | K::SIZE;
        self.control(erase);
        self.control(erase | AT_IT);
    }

    fn set_write_enable(&mut self, on: bool) {
        self.control(K::SIZE | if on { PROGRAM } else { 0 });
    }

    fn is_busy(&self) -> bool {
        self.registers.sr().read().bits() & AT_IT != 0
    }

    fn lock(&mut self) {
        self.control(LOCK);
        self.registers.acr().modify(|_, w| w.dcrst().set_bit());
        self.registers.acr().modify(|_, w| w.dcrst().clear_bit().dcen().set_bit());
    }

    fn read(&mut self, words: &mut dyn FnMut()) -> bool {
        self.kind.read(words)
    }

    fn has_supply(&mut self) -> bool {
        self.kind.has_supply()
    }
}

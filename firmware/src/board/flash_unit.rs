//! The flash controller that STM32F4 and STM32G4 share but for numbers: one control and one status register, caches in front.
//! Which page is erased, and how much is written at a time, each board says.

use super::flash_page::{Flash, KEYS};
use super::pac::FLASH;

/// Bits that differ.
pub struct Bits {
    /// Flags of errors, cleared by ones.
    pub errors: u32,
    /// Erases the page.
    pub erase: u32,
    /// How much is written at a time, beside the bit that takes writes.
    pub size: u32,
}

/// Begins to erase, in the control register; still at it, in the status register.
const AT_IT: u32 = 1 << 16;
/// Takes writes.
const PROGRAM: u32 = 1;
/// No more changes.
const LOCK: u32 = 1 << 31;

/// The controller, for a page at an address and so many words at a time.
pub struct FlashUnit<const ADDRESS: usize, const TOGETHER: usize> {
    registers: FLASH,
    bits: Bits,
}

impl<const ADDRESS: usize, const TOGETHER: usize> FlashUnit<ADDRESS, TOGETHER> {
    /// Of a board.
    pub fn new(registers: FLASH, bits: Bits) -> Self {
        Self { registers, bits }
    }

    fn control(&mut self, bits: u32) {
        // SAFETY: what it erases is the page that is nobody else's; all other bits do nothing without it.
        self.registers.cr().write(|w| unsafe { w.bits(bits) });
    }
}

impl<const ADDRESS: usize, const TOGETHER: usize> Flash for FlashUnit<ADDRESS, TOGETHER> {
    const ADDRESS: usize = ADDRESS;
    const TOGETHER: usize = TOGETHER;

    fn unlock(&mut self) {
        // What is read beside a bank at work would spoil the data cache of STM32G4 (errata sheet ES0430, 2.2.2).
        self.registers.acr().modify(|_, w| w.dcen().clear_bit());
        // Keys that come while it is open would close it until the next reset.
        if self.registers.cr().read().bits() & LOCK != 0 {
            for key in KEYS {
                // SAFETY: the key register takes every word.
                self.registers.keyr().write(|w| unsafe { w.bits(key) });
            }
        }
        // SAFETY: ones clear the flags of errors.
        self.registers.sr().write(|w| unsafe { w.bits(self.bits.errors) });
    }

    fn erase(&mut self) {
        self.control(self.bits.erase | self.bits.size);
        self.control(self.bits.erase | self.bits.size | AT_IT);
    }

    fn take_writes(&mut self, on: bool) {
        self.control(self.bits.size | if on { PROGRAM } else { 0 });
    }

    fn is_busy(&self) -> bool {
        self.registers.sr().read().bits() & AT_IT != 0
    }

    fn lock(&mut self) {
        self.control(LOCK);
        self.registers.acr().modify(|_, w| w.dcrst().set_bit());
        self.registers.acr().modify(|_, w| w.dcrst().clear_bit().dcen().set_bit());
    }
}

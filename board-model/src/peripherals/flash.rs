//! What flash controllers share: the array behind the image, with words that a lost power has left damaged.

use std::collections::BTreeSet;

use crate::register::{Registers, bit, bits};
use crate::wires::{Time, Wires};

/// The access control register of all three chips.
pub const ACR: u32 = 0x00;
/// First address of flash on all three chips.
pub const BASE: u32 = 0x0800_0000;
/// Keys of the control register: RM0090 3.6.1, RM0440 3.3.5, RM0433 4.5.1.
pub const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Flash that no image is in.
#[derive(Debug, Clone)]
pub struct Array {
    start: u32,
    bytes: Vec<u8>,
    /// Bytes that are corrected or checked together.
    word: u32,
    damaged: BTreeSet<u32>,
}

impl Array {
    /// Erased, from an address to the end of a flash of a size.
    pub fn new(start: u32, size: u32, word: u32) -> Self {
        Self { start, bytes: vec![0xff; (BASE + size).saturating_sub(start) as usize], word, damaged: BTreeSet::new() }
    }

    /// Whether an address is in it.
    pub fn holds(&self, address: u32) -> bool {
        address >= self.start && ((address - self.start) as usize) < self.bytes.len()
    }

    /// What is there, little endian.
    pub fn read(&self, address: u32, size: u32) -> u64 {
        let place = (address - self.start) as usize;
        let bytes = self.bytes.iter().skip(place).take(size as usize);
        bytes.rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
    }

    /// Whether the word around an address was left damaged.
    pub fn is_damaged(&self, address: u32) -> bool {
        self.damaged.contains(&(address / self.word))
    }

    /// Whether all of the word around an address is as erased.
    pub fn is_erased(&self, address: u32) -> bool {
        let first = address / self.word * self.word;
        (0..self.word).all(|byte| self.read(first + byte, 1) == 0xff) && !self.is_damaged(address)
    }

    /// Clears bits: a program can do nothing else.
    pub fn program(&mut self, address: u32, size: u32, value: u64) {
        for index in 0..size {
            if let Some(byte) = self.bytes.get_mut((address + index - self.start) as usize) {
                *byte &= (value >> (8 * index)) as u8;
            }
        }
    }

    /// Erases from an address on; what of it the image holds is a violation.
    pub fn erase(&mut self, address: u32, size: u32, wires: &mut Wires) {
        if address < wires.image_end {
            wires.violation("FLASH", format!("the image is erased at {address:#010x}"), "the image");
        }
        for place in (address..address + size).filter(|place| *place >= self.start) {
            if let Some(byte) = self.bytes.get_mut((place - self.start) as usize) {
                *byte = 0xff;
            }
        }
        self.damaged.retain(|word| !(address..address + size).contains(&(word * self.word)));
    }

    /// Power went while the words of a range were erased or programmed.
    pub fn damage(&mut self, address: u32, size: u32) {
        self.damaged.extend((address / self.word)..(address + size).div_ceil(self.word));
    }
}

/// The caches in front of the flash of F405 and G474, by their access control register: RM0090 3.9.1, RM0440 3.7.1.
#[derive(Debug, Clone)]
pub struct Caches {
    /// Sections of the register, and of what a cache returns.
    sections: [&'static str; 2],
    /// That of data may hold what was there before.
    stale: bool,
}

impl Caches {
    /// ICEN, DCEN, ICRST and DCRST.
    const ENABLES: [u32; 2] = [9, 10];
    const RESETS: [u32; 2] = [11, 12];
    /// Bits that writes change by way of [`Caches::written`].
    pub const SPECIAL: u32 = bits(12, 11);

    /// Empty, with the sections of the access control register and of what a cache returns.
    pub fn new(sections: [&'static str; 2]) -> Self {
        Self { sections, stale: false }
    }

    /// Whether that of data is on.
    fn keeps_data(registers: &Registers) -> bool {
        registers.is_set(ACR, Self::ENABLES[1])
    }

    /// The access control register was written.
    pub fn written(&mut self, value: u32, registers: &mut Registers, wires: &mut Wires) {
        for ((reset, enable), what) in Self::RESETS.into_iter().zip(Self::ENABLES).zip(["instruction", "data"]) {
            if value & bit(reset) != 0 && value & bit(enable) != 0 {
                let what = format!("the {what} cache is reset while it is on");
                wires.violation("FLASH_ACR", what, self.sections[0]);
            }
        }
        if value & bit(Self::RESETS[1]) != 0 && value & bit(Self::ENABLES[1]) == 0 {
            self.stale = false;
        }
        registers.change(ACR, value & Self::SPECIAL, Self::SPECIAL);
    }

    /// Flash changes; whether the cache of data is on while it does.
    pub fn flash_changes(&mut self, registers: &Registers) -> bool {
        let is_on = Self::keeps_data(registers);
        self.stale |= is_on;
        is_on
    }

    /// Flash is read.
    pub fn flash_is_read(&self, wires: &mut Wires) {
        if self.stale {
            let what = "is read through a data cache that was not reset since flash was changed";
            wires.violation("flash", what, self.sections[1]);
        }
    }

    /// As after a reset.
    pub fn reset(&mut self) {
        self.stale = false;
    }
}

/// An erase or a program under way.
#[derive(Debug, Clone, Copy, Default)]
pub struct Work {
    until: Time,
}

impl Work {
    /// One that takes a time begins.
    pub fn begin(&mut self, duration: Time, wires: &Wires) {
        self.until = wires.now + duration;
    }

    /// Whether it goes on.
    pub fn goes_on(self, wires: &Wires) -> bool {
        self.left(wires) > 0
    }

    /// Time to its end, which whoever reads or writes there meanwhile waits.
    pub fn left(self, wires: &Wires) -> Time {
        self.until.saturating_sub(wires.now)
    }
}

/// The sequence of keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lock {
    /// Nothing, or the first key.
    Locked {
        /// Keys taken so far.
        keys: usize,
    },
    /// Open.
    Open,
    /// A wrong key was given: locked until the next reset.
    Shut,
}

impl Default for Lock {
    fn default() -> Self {
        Self::Locked { keys: 0 }
    }
}

impl Lock {
    /// A key is written.
    pub fn key(&mut self, key: u32, register: &str, wires: &mut Wires) {
        *self = match *self {
            Self::Locked { keys } if key == KEYS[keys] => {
                if keys == 1 {
                    Self::Open
                } else {
                    Self::Locked { keys: 1 }
                }
            }
            Self::Open => {
                wires.violation(register, "is written while unlocked: locks until the next reset", "RM0090 3.6.1");
                wires.bus_fault = Some(0);
                Self::Shut
            }
            _ => {
                wires.violation(register, "a wrong key: locked until the next reset", "RM0090 3.6.1, RM0440 3.3.5");
                wires.bus_fault = Some(0);
                Self::Shut
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wires::Surroundings;

    fn wires() -> Wires {
        Wires::new(Surroundings::default(), 9600)
    }

    #[test]
    fn a_program_clears_bits_and_an_erase_sets_them() {
        let mut array = Array::new(BASE + 0x1000, 0x4000, 8);
        array.program(BASE + 0x2000, 4, 0x1234_5678);
        array.program(BASE + 0x2000, 4, 0xffff_0000);
        assert_eq!(array.read(BASE + 0x2000, 8), 0xffff_ffff_1234_0000);
        array.damage(BASE + 0x2000, 1);
        assert!(array.is_damaged(BASE + 0x2007) && !array.is_erased(BASE + 0x2000));
        array.erase(BASE + 0x2000, 0x1000, &mut wires());
        assert!(array.is_erased(BASE + 0x2000));
    }

    #[test]
    fn one_wrong_key_shuts_the_lock() {
        let mut wires = wires();
        let mut lock = Lock::default();
        KEYS.into_iter().for_each(|key| lock.key(key, "KEYR", &mut wires));
        assert_eq!((lock, wires.violations.all().len()), (Lock::Open, 0));
        lock.key(KEYS[0], "KEYR", &mut wires);
        assert_eq!((lock, wires.violations.all().len()), (Lock::Shut, 1));
    }
}

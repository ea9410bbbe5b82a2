//! Parts shared by the flash controllers: the array behind the image, with words damaged by a loss of power.

use std::collections::BTreeSet;

use crate::register::{Registers, bit, bits};
use crate::wires::{HowFar, Time, Wires};

/// The access control register of all three chips.
pub const ACR: u32 = 0x00;
/// First address of flash on all three chips.
pub const BASE: u32 = 0x0800_0000;
/// Keys of the control register: RM0090 3.6.1, RM0440 3.3.5, RM0433 4.5.1.
pub const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Flash outside of the image.
#[derive(Debug, Clone)]
pub struct Array {
    start: u32,
    bytes: Vec<u8>,
    /// Size of a word: programmed together, and checked together if there are check bits [byte].
    word: u32,
    has_check_bits: bool,
    damaged: BTreeSet<u32>,
}

impl Array {
    /// Erased array from an address to the end of the flash.
    pub fn new(start: u32, size: u32, word: u32, has_check_bits: bool) -> Self {
        let bytes = vec![0xff; (BASE + size).saturating_sub(start) as usize];
        Self { start, bytes, word, has_check_bits, damaged: BTreeSet::new() }
    }

    /// Returns whether an address is in the array.
    pub fn holds(&self, address: u32) -> bool {
        address >= self.start && ((address - self.start) as usize) < self.bytes.len()
    }

    /// Reads little-endian data.
    pub fn read(&self, address: u32, size: u32) -> u64 {
        let place = (address - self.start) as usize;
        let bytes = self.bytes.iter().skip(place).take(size as usize);
        bytes.rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
    }

    /// Returns whether the check bits of the word around an address are wrong.
    pub fn is_damaged(&self, address: u32) -> bool {
        self.damaged.contains(&(address / self.word))
    }

    /// Returns whether the word around an address is erased.
    pub fn is_erased(&self, address: u32) -> bool {
        let first = address / self.word * self.word;
        (0..self.word).all(|byte| self.read(first + byte, 1) == 0xff) && !self.is_damaged(address)
    }

    /// Clears bits, the only effect of a program.
    pub fn program(&mut self, address: u32, size: u32, value: u64) {
        for index in 0..size {
            if let Some(byte) = self.bytes.get_mut((address + index - self.start) as usize) {
                *byte &= (value >> (8 * index)) as u8;
            }
        }
    }

    /// Programs a word incompletely: power fails, only some of the bits are cleared, and the check bits are wrong.
    pub fn leave_programmed(&mut self, address: u32, size: u32, value: u64, how_far: HowFar) {
        if how_far != HowFar::Before {
            self.program(address, size, value | noise(address));
            self.damage(address);
        }
    }

    /// Erases a range; erasing a part of the image is a violation.
    pub fn erase(&mut self, address: u32, size: u32, wires: &mut Wires) {
        self.spare_image(address, wires);
        self.erase_words(address, size, |_| Left::Erased);
    }

    /// Erases incompletely: power fails, and each word is unchanged, erased, or damaged.
    pub fn leave_erased(&mut self, address: u32, size: u32, how_far: HowFar, wires: &mut Wires) {
        self.spare_image(address, wires);
        // Eighths of the words that are unchanged, and that are erased.
        let (old, erased) = match how_far {
            HowFar::Before => (8, 0),
            HowFar::Early => (6, 0),
            HowFar::Middle => (2, 2),
            HowFar::Late => (0, 6),
        };
        self.erase_words(address, size, |word| match noise(word) % 8 {
            part if part < old => Left::Old,
            part if part < old + erased => Left::Erased,
            _ => Left::Neither,
        });
    }

    fn spare_image(&self, address: u32, wires: &mut Wires) {
        if address < wires.image_end {
            wires.violation("FLASH", format!("the image is erased at {address:#010x}"), "the image");
        }
    }

    fn erase_words(&mut self, address: u32, size: u32, left: impl Fn(u32) -> Left) {
        for word in (address.max(self.start)..address + size).step_by(self.word as usize) {
            let place = (word - self.start) as usize;
            let Some(bytes) = self.bytes.get_mut(place..place + self.word as usize) else { continue };
            match left(word) {
                Left::Old => {}
                Left::Erased => {
                    bytes.fill(0xff);
                    self.damaged.remove(&(word / self.word));
                }
                Left::Neither => {
                    let noise = noise(word).to_le_bytes();
                    bytes.iter_mut().zip(noise.iter().cycle()).for_each(|(byte, noise)| *byte = *noise);
                    self.damage(word);
                }
            }
        }
    }

    fn damage(&mut self, address: u32) {
        if self.has_check_bits {
            self.damaged.insert(address / self.word);
        }
    }
}

/// State of a word after an interrupted erase.
enum Left {
    Old,
    Erased,
    Neither,
}

/// Pseudo-random bits, equal in every run.
fn noise(address: u32) -> u64 {
    let mixed = u64::from(address / 4).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 3
}

/// Caches in front of the flash of F405 and G474, by their access control register: RM0090 3.9.1, RM0440 3.7.1.
#[derive(Debug, Clone)]
pub struct Caches {
    /// Sections of the register, and of the returned data.
    sections: [&'static str; 2],
    /// True if the data cache is on after a reset.
    is_on_after_reset: bool,
    /// True if the data cache holds data, even while it is off.
    filled: bool,
    /// True if the held data may be outdated.
    stale: bool,
}

impl Caches {
    /// Positions of ICEN and DCEN, and of ICRST and DCRST.
    const ENABLES: [u32; 2] = [9, 10];
    const RESETS: [u32; 2] = [11, 12];
    /// Bits that only [`Caches::written`] changes.
    pub const SPECIAL: u32 = bits(12, 11);

    /// Caches after a reset, with the sections of the access control register and of the returned data.
    pub fn new(sections: [&'static str; 2], is_on_after_reset: bool) -> Self {
        Self { sections, is_on_after_reset, filled: is_on_after_reset, stale: false }
    }

    /// Returns whether the data cache is on.
    fn keeps_data(registers: &Registers) -> bool {
        registers.is_set(ACR, Self::ENABLES[1])
    }

    /// Handles a write of the access control register.
    pub fn written(&mut self, value: u32, registers: &mut Registers, wires: &mut Wires) {
        for ((reset, enable), what) in Self::RESETS.into_iter().zip(Self::ENABLES).zip(["instruction", "data"]) {
            if value & bit(reset) != 0 && value & bit(enable) != 0 {
                let what = format!("the {what} cache is reset while it is on");
                wires.violation("FLASH_ACR", what, self.sections[0]);
            }
        }
        self.filled |= Self::keeps_data(registers);
        if value & bit(Self::RESETS[1]) != 0 && value & bit(Self::ENABLES[1]) == 0 {
            (self.filled, self.stale) = (false, false);
        }
        registers.change(ACR, value & Self::SPECIAL, Self::SPECIAL);
    }

    /// Records a change of flash; returns whether the data cache is on.
    pub fn flash_changes(&mut self, registers: &Registers) -> bool {
        self.stale |= self.filled;
        Self::keeps_data(registers)
    }

    /// Checks a read of flash.
    pub fn flash_is_read(&self, registers: &Registers, wires: &mut Wires) {
        if self.stale && Self::keeps_data(registers) {
            let what = "is read through a data cache that was not reset since flash was changed";
            wires.violation("flash", what, self.sections[1]);
        }
    }

    /// Resets the caches.
    pub fn reset(&mut self) {
        *self = Self::new(self.sections, self.is_on_after_reset);
    }
}

/// Erase or program in progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Work {
    until: Time,
}

impl Work {
    /// Starts an operation of a duration.
    pub fn begin(&mut self, duration: Time, wires: &Wires) {
        self.until = wires.now + duration;
    }

    /// Returns whether the operation is in progress.
    pub fn goes_on(self, wires: &Wires) -> bool {
        self.left(wires) > 0
    }

    /// Remaining time, for which accesses to the same bank wait.
    pub fn left(self, wires: &Wires) -> Time {
        self.until.saturating_sub(wires.now)
    }
}

/// Lock with a sequence of keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lock {
    /// No key yet, or the first one.
    Locked {
        /// Number of accepted keys.
        keys: usize,
    },
    /// Unlocked.
    Open,
    /// A wrong key was written: locked until the next reset.
    Shut,
}

impl Default for Lock {
    fn default() -> Self {
        Self::Locked { keys: 0 }
    }
}

impl Lock {
    /// Handles a write of a key.
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
    use crate::chips;
    use crate::machine::Machine;
    use crate::wires::{Cable, Surroundings};

    fn wires() -> Wires {
        Wires::new(Surroundings::default(), Cable::default())
    }

    #[test]
    fn program_clears_and_erase_sets_bits() {
        let mut array = Array::new(BASE + 0x1000, 0x4000, 8, true);
        array.program(BASE + 0x2000, 4, 0x1234_5678);
        array.program(BASE + 0x2000, 4, 0xffff_0000);
        assert_eq!(array.read(BASE + 0x2000, 8), 0xffff_ffff_1234_0000);
        array.erase(BASE + 0x2000, 0x1000, &mut wires());
        assert!(array.is_erased(BASE + 0x2000));
    }

    #[test]
    fn option_bytes_untouched() {
        let machine = |chip| Machine::new(chip, Surroundings::default(), Cable::default(), 1000);
        for (mut machine, writes) in [
            // Keys of the options, the options, and on the STM32G474 their reload.
            (machine(chips::f405::chip(BASE + 0x1000)), &[(0x4002_3c08, 0x0819_2a3b), (0x4002_3c14, 0x0fff_aaee)][..]),
            (
                machine(chips::g474::chip(BASE + 0x1000)),
                &[(0x4002_200c, 0x0819_2a3b), (0x4002_2020, 0xffaf_f8aa), (0x4002_2014, 1 << 27)],
            ),
            (machine(chips::h743::chip(BASE + 0x1000)), &[(0x5200_2008, 0x0819_2a3b), (0x5200_2018, 2)]),
        ] {
            machine.settle();
            let count = |machine: &Machine| {
                let said = machine.wires.violations.all().iter();
                said.filter(|said| said.what.contains("option bytes")).map(|said| said.times).sum::<u32>()
            };
            for (number, (address, value)) in writes.iter().enumerate() {
                machine.write(*address, 4, *value);
                assert_eq!(count(&machine), number as u32 + 1, "{}: {address:#010x}", machine.chip.name);
            }
        }
    }

    #[test]
    fn cut_word_neither_old_nor_new() {
        let mut array = Array::new(BASE, 0x4000, 8, true);
        array.leave_programmed(BASE, 8, 0, HowFar::Before);
        assert!(array.is_erased(BASE) && !array.is_damaged(BASE));
        array.leave_programmed(BASE, 8, 0, HowFar::Middle);
        assert!(array.is_damaged(BASE + 7) && !array.is_damaged(BASE + 8));
        assert!(![0, u64::MAX].contains(&array.read(BASE, 8)));
    }

    #[test]
    fn cut_erase_leaves_mixed_words() {
        for (how_far, expected) in [
            (HowFar::Before, [true, false, false]),
            (HowFar::Early, [true, false, true]),
            (HowFar::Middle, [true, true, true]),
            (HowFar::Late, [false, true, true]),
        ] {
            let mut array = Array::new(BASE, 0x4000, 8, true);
            (0..0x800).step_by(8).for_each(|place| array.program(BASE + place, 8, 0x1234));
            array.leave_erased(BASE, 0x800, how_far, &mut wires());
            let words: Vec<u32> = (BASE..BASE + 0x800).step_by(8).collect();
            let old = words.iter().any(|word| array.read(*word, 8) == 0x1234 && !array.is_damaged(*word));
            let erased = words.iter().any(|word| array.is_erased(*word));
            let damaged = words.iter().any(|word| array.is_damaged(*word));
            assert_eq!([old, erased, damaged], expected, "{how_far:?}");
        }
    }

    #[test]
    fn wrong_key_closes_lock() {
        let mut wires = wires();
        let mut lock = Lock::default();
        KEYS.into_iter().for_each(|key| lock.key(key, "KEYR", &mut wires));
        assert_eq!((lock, wires.violations.all().len()), (Lock::Open, 0));
        lock.key(KEYS[0], "KEYR", &mut wires);
        assert_eq!((lock, wires.violations.all().len()), (Lock::Shut, 1));
    }
}

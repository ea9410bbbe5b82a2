//! Flash controllers of STM32G474 (category 3), RM0440 section 3, and of STM32G431 (category 2), section 5: double
//! words with check bits. Category 3 has two banks, and code in one runs while the other is busy, or by an option byte
//! one bank with pages of twice the size; category 2 has one bank with pages of 2 KiB. Sections are those of category
//! 3.

use super::Peripheral;
use super::flash::{ACR, Array, BASE, Caches, Lock, Work};
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{MICROSECOND, Operation, Time, Wires};

const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
const ECCR: u32 = 0x18;
const OPTR: u32 = 0x20;
/// Category 3: 512 KiB in two banks.
const SIZE: u32 = 0x8_0000;
const BANK: u32 = SIZE / 2;
/// Category 2: 128 KiB.
const SMALL_SIZE: u32 = 0x2_0000;
const PAGE: u32 = 0x800;
const DOUBLE_WORD: u32 = 8;
/// Error flags of two-bit errors.
const ECCD: u32 = bit(31);
const ECCD2: u32 = bit(29);
const ERRORS: u32 = 0xc3fa;

/// RM0440 3.7, 5.7: category 2 has no MER2, BKER, SEC_PROT2, ECCD2, ECCC2, BK_ECC, DBANK and BFB2.
static CATEGORY_3: [Register; 8] = map(0xff07_8bff, 0xf167_ffff, 0x7fdf_77ff);
static CATEGORY_2: [Register; 8] = map(0xdf07_03ff, 0xc147_ffff, 0x7f8f_77ff);

/// Register map, with the fields of the three registers that differ.
const fn map(control: u32, check: u32, options: u32) -> [Register; 8] {
    [
        Register::new("FLASH_ACR", ACR, 0x0004_0600, 0x0004_7f0f).special(Caches::SPECIAL),
        Register::new("FLASH_PDKEYR", 0x04, 0, u32::MAX).special(u32::MAX).any_value(),
        Register::new("FLASH_KEYR", KEYR, 0, u32::MAX).special(u32::MAX).any_value(),
        Register::new("FLASH_OPTKEYR", 0x0c, 0, u32::MAX).special(u32::MAX).any_value(),
        Register::new("FLASH_SR", SR, 0, 0x0001_c3fb).special(u32::MAX),
        Register::new("FLASH_CR", CR, 0xc000_0000, control).special(u32::MAX),
        Register::new("FLASH_ECCR", ECCR, 0, check).special(u32::MAX),
        // DBANK (22) is 1 in the factory setting.
        Register::new("FLASH_OPTR", OPTR, 0xffef_f8aa, options).special(u32::MAX),
    ]
}

/// Data sheet of STM32G474, table 52: 22 ms per page, 82 us per double word.
const ERASE: Time = 22_000 * MICROSECOND;
const PROGRAM: Time = 82 * MICROSECOND;

/// Flash controller.
#[derive(Debug)]
pub struct Flash {
    registers: Registers,
    has_two_banks: bool,
    array: Array,
    lock: Lock,
    work: Work,
    /// First half of a double word, with its address.
    half: Option<(u32, u32)>,
    caches: Caches,
}

impl Flash {
    /// Controller of the STM32G474, with an image that ends at an address.
    pub fn category_3(image_end: u32) -> Self {
        Self::with(&CATEGORY_3, true, Array::new(image_end, SIZE, DOUBLE_WORD, true))
    }

    /// Controller of the STM32G431, with an image that ends at an address.
    pub fn category_2(image_end: u32) -> Self {
        Self::with(&CATEGORY_2, false, Array::new(image_end, SMALL_SIZE, DOUBLE_WORD, true))
    }

    fn with(table: &'static [Register], has_two_banks: bool, array: Array) -> Self {
        Self {
            registers: Registers::new(table),
            has_two_banks,
            array,
            lock: Lock::default(),
            work: Work::default(),
            half: None,
            caches: Caches::new(["RM0440 3.7.1", "RM0440 3.3.4"], true),
        }
    }

    /// Returns whether the core waits for an operation on an address.
    /// RM0440 3.3.6: reads of the busy bank wait for the operation, including instruction fetches.
    fn holds_up(&self, address: u32, wires: &Wires) -> bool {
        !self.has_two_banks || wires.single_bank || address < BASE + BANK
    }

    /// Starts an operation on an address.
    fn work(&mut self, address: u32, duration: Time, wires: &mut Wires) {
        self.work.begin(duration, wires);
        if self.caches.flash_changes(&self.registers) && !self.holds_up(address, wires) {
            // ES0430 2.2.2: a read of one bank while the other is busy may corrupt the data cache.
            let what = "the data cache is on while a bank is erased or programmed beside running code";
            wires.violation("FLASH_ACR", what, "ES0430 2.2.2");
        }
        if self.holds_up(address, wires) {
            wires.stall += duration;
        }
    }

    fn control_written(&mut self, value: u32, wires: &mut Wires) {
        // OPTSTRT and OBL_LAUNCH.
        if value & (bit(17) | bit(27)) != 0 {
            wires.violation("FLASH_CR", "option bytes are not modelled and not to be touched", "RM0440 3.4.2");
        }
        let kept = self.registers.get(CR) & bit(30);
        if value & bit(31) != 0 {
            self.lock = Lock::default();
            self.registers.set(CR, bit(31) | bit(30));
            return;
        }
        if self.lock != Lock::Open {
            wires.violation("FLASH_CR", "is written while locked: the keys first", "RM0440 3.3.5");
            return;
        }
        if self.work.goes_on(wires) {
            wires.violation("FLASH_CR", "is written while BSY is 1", "RM0440 3.7.6");
        }
        self.registers.set(CR, value & !bit(16) | kept);
        if value & bit(16) != 0 {
            self.erase(value, wires);
        }
    }

    fn erase(&mut self, control: u32, wires: &mut Wires) {
        if control & bit(1) == 0 || control & (bit(2) | bit(15) | bit(0)) != 0 {
            wires.violation("FLASH_CR", "starts an erase of no page, or of more", "RM0440 3.3.6");
            return;
        }
        if self.registers.get(SR) & ERRORS != 0 {
            wires.violation("FLASH_CR", "an erase starts while an error flag is up", "RM0440 3.3.6");
        }
        let (page, bank) = (control >> 3 & 0x7f, control >> 11 & 1);
        if !self.has_two_banks && page >= SMALL_SIZE / PAGE {
            wires.violation("FLASH_CR", format!("there is no page {page}"), "RM0440 5.3.1");
            return;
        }
        if self.has_two_banks && wires.single_bank && bank != 0 {
            wires.violation("FLASH_CR", "BKER is 1 while DBANK is 0: there is one bank", "RM0440 3.3.1, 3.7.6");
        }
        let (first, size) = match self.has_two_banks && wires.single_bank {
            true => (BASE + 2 * PAGE * page, 2 * PAGE),
            false => (BASE + BANK * bank + PAGE * page, PAGE),
        };
        if let Some(how_far) = wires.begins_flash_operation(Operation::Erase) {
            self.array.leave_erased(first, size, how_far, wires);
            return;
        }
        self.array.erase(first, size, wires);
        self.work(first, ERASE, wires);
    }

    /// Programs a complete double word.
    fn program(&mut self, address: u32, value: u64, wires: &mut Wires) {
        if !self.array.is_erased(address) && value != 0 {
            self.registers.change(SR, bit(3), 0);
            wires.violation("flash", "is programmed over what is not erased", "RM0440 3.3.7 PROGERR");
            return;
        }
        if let Some(how_far) = wires.begins_flash_operation(Operation::Program) {
            self.array.leave_programmed(address, DOUBLE_WORD, value, how_far);
            return;
        }
        self.array.program(address, DOUBLE_WORD, value);
        self.work(address, PROGRAM, wires);
    }
}

impl Peripheral for Flash {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        wires.waiting = offset == SR && self.work.goes_on(wires);
        self.registers.get(offset)
    }

    fn written(&mut self, offset: u32, value: u32, _before: u32, wires: &mut Wires) {
        match offset {
            ACR => self.caches.written(value, &mut self.registers, wires),
            KEYR => self.lock.key(value, "FLASH_KEYR", wires),
            SR => self.registers.change(SR, 0, value & 0xc3fb),
            CR => self.control_written(value, wires),
            // ECCC (30) and ECCD (31) are cleared by writing ones.
            ECCR => self.registers.change(ECCR, value & bit(24), value & bits(31, 28) | bit(24)),
            _ => wires.violation("FLASH", "option bytes are not modelled and not to be touched", "RM0440 3.4"),
        }
        if self.lock == Lock::Open {
            self.registers.change(CR, 0, bit(31));
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        if self.has_two_banks {
            // DBANK.
            self.registers.change(OPTR, u32::from(!wires.single_bank) << 22, bit(22));
        }
        let busy = self.work.goes_on(wires);
        self.registers.change(SR, u32::from(busy) << 16, bit(16));
        let waits = u64::from(self.registers.field(ACR, 0, 4));
        // RM0440 3.3.3, table 9: clock per wait state in range 1 boost, range 1 normal, range 2.
        let step = match (wires.voltage, wires.boost) {
            (2, _) => 12_000_000,
            (_, true) => 34_000_000,
            (_, false) => 30_000_000,
        };
        if wires.clocks.bus > (waits + 1) * step {
            let what = format!("{waits} wait states are too few for {} Hz", wires.clocks.bus);
            wires.violation("FLASH_ACR", what, "RM0440 3.3.3, table 9");
        }
        // RM0440 3.3.8: the flag of a two-bit error holds the non-maskable interrupt.
        wires.non_maskable |= self.registers.get(ECCR) & (ECCD | ECCD2) != 0;
    }

    fn reset(&mut self) {
        self.registers.reset();
        self.lock = Lock::default();
        (self.work, self.half) = (Work::default(), None);
        self.caches.reset();
    }

    fn read_memory(&mut self, address: u32, size: u32, wires: &mut Wires) -> Option<u64> {
        if !self.array.holds(address) {
            return None;
        }
        self.caches.flash_is_read(&self.registers, wires);
        if self.array.is_damaged(address) {
            // RM0440 3.7.7: the register keeps the first error, with its bank and its offset in the bank.
            // In single-bank mode two double words are read together, and the second one has its own flag.
            let offset = (address - BASE) / DOUBLE_WORD * DOUBLE_WORD;
            let (flag, bank, place) = match wires.single_bank && self.has_two_banks {
                true if offset & DOUBLE_WORD != 0 => (ECCD2, 0, offset - DOUBLE_WORD),
                true => (ECCD, 0, offset),
                false => (ECCD, offset / BANK, offset % BANK),
            };
            if self.registers.get(ECCR) & (ECCD | ECCD2) == 0 {
                self.registers.change(ECCR, flag | bank << 21 | place, bit(21) | bits(18, 0));
            }
            self.advance(wires);
        }
        if !self.holds_up(address, wires) {
            wires.stall += self.work.left(wires);
        }
        Some(self.array.read(address, size))
    }

    fn write_memory(&mut self, address: u32, size: u32, value: u64, wires: &mut Wires) -> bool {
        if !self.array.holds(address) {
            return false;
        }
        let (error, what, section) = if !self.registers.is_set(CR, 0) || self.lock != Lock::Open {
            (bit(7), "is written while PG is 0", "RM0440 3.3.7 PGSERR")
        } else if size < 4 {
            (bit(6), "is written by less than a word", "RM0440 3.3.7 SIZERR")
        } else if self.work.goes_on(wires) {
            (bit(7), "is written while BSY is 1", "RM0440 3.3.7")
        } else if self.registers.get(SR) & ERRORS != 0 {
            (bit(7), "is written while an error flag is up", "RM0440 3.3.7 PGSERR")
        } else if size == 4
            && (self.half.is_none() && !address.is_multiple_of(8)
                || self.half.is_some_and(|(first, _)| address != first + 4))
        {
            (bit(5), "the words of a double word do not follow each other", "RM0440 3.3.7 PGAERR")
        } else {
            (0, "", "")
        };
        if error != 0 {
            self.registers.change(SR, error, 0);
            self.half = None;
            wires.violation("flash", what, section);
            return true;
        }
        match (size, self.half.take()) {
            (4, None) => self.half = Some((address, value as u32)),
            (4, Some((first, low))) => self.program(first, value << 32 | u64::from(low), wires),
            _ => self.program(address, value, wires),
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::KEYS;
    use crate::scs::{Masks, NMI};
    use crate::wires::{Cable, Cut, HowFar, Surroundings};

    const FLASH: u32 = 0x4002_2000;
    const PLACE: u32 = BASE + 0x7_f010;

    /// There is no second bank then.
    #[test]
    fn single_bank_doubles_page_size() {
        let chip = chips::g474::chip(BASE + 0x1000);
        let mut machine = Machine::new(chip, Surroundings::default(), Cable::default(), 1000);
        machine.wires.single_bank = true;
        machine.settle();
        assert_eq!(machine.read(FLASH + OPTR, 4) >> 22 & 1, 0);
        KEYS.into_iter().for_each(|key| machine.write(FLASH + KEYR, 4, key.into()));
        for place in [BASE + 0x7_f000, BASE + 0x7_f800] {
            machine.write(FLASH + CR, 4, 1);
            machine.write(place, 8, 0x1234);
            machine.settle();
        }
        machine.write(FLASH + ACR, 4, 0x0004_0200);
        machine.write(FLASH + ACR, 4, 0x0004_1200);
        machine.write(FLASH + ACR, 4, 0x0004_0200);
        machine.write(FLASH + CR, 4, 1 << 16 | 127 << 3 | 2);
        machine.settle();
        assert_eq!([0x7_f000, 0x7_f800].map(|place| machine.read(BASE + place, 4)), [0xffff_ffff; 2]);
        assert_eq!(machine.wires.violations.all(), []);
        machine.write(FLASH + CR, 4, 1 << 16 | 1 << 11 | 127 << 3 | 2);
        assert!(machine.wires.violations.all()[0].what.contains("BKER"));
    }

    #[test]
    fn one_bank_chip_has_64_pages() {
        let mut machine =
            Machine::new(chips::g431::chip(BASE + 0x1000), Surroundings::default(), Cable::default(), 1000);
        machine.settle();
        KEYS.into_iter().for_each(|key| machine.write(FLASH + KEYR, 4, key.into()));
        for place in [BASE + 0x1_f000, BASE + 0x1_f800] {
            machine.write(FLASH + CR, 4, 1);
            machine.write(place, 8, 0x1234);
            machine.settle();
        }
        machine.write(FLASH + ACR, 4, 0x0004_0200);
        machine.write(FLASH + ACR, 4, 0x0004_1200);
        machine.write(FLASH + ACR, 4, 0x0004_0200);
        machine.write(FLASH + CR, 4, 1 << 16 | 63 << 3 | 2);
        machine.settle();
        assert_eq!([0x1_f000, 0x1_f800].map(|place| machine.read(BASE + place, 4)), [0x1234, 0xffff_ffff]);
        assert_eq!(machine.wires.violations.all(), []);
        machine.write(FLASH + CR, 4, 1 << 16 | 1 << 11 | 63 << 3 | 2);
        machine.settle();
        machine.write(FLASH + CR, 4, 1 << 16 | 64 << 3 | 2);
        let said: Vec<_> = machine.wires.violations.all().iter().map(|violation| violation.what.as_str()).collect();
        assert_eq!(said, ["reserved bits 0x00000800 are written", "there is no page 64"]);
    }

    /// Until its flag is cleared.
    #[test]
    fn cut_double_word_repeats_nmi() {
        let chip = chips::g474::chip(BASE + 0x1000);
        let mut machine = Machine::new(chip, Surroundings::default(), Cable::default(), 1000);
        machine.settle();
        machine.wires.cut = Some(Cut { operation: 0, how_far: HowFar::Middle });
        KEYS.into_iter().for_each(|key| machine.write(FLASH + KEYR, 4, key.into()));
        machine.write(FLASH + ACR, 4, 0x0004_0200);
        machine.write(FLASH + CR, 4, 1);
        machine.write(PLACE, 4, 0x1234);
        machine.write(PLACE + 4, 4, 0x5678);
        assert_eq!(machine.wires.reset.take(), Some(crate::wires::Reset::Power));
        machine.reset(crate::wires::Reset::Power);
        machine.settle();
        assert_eq!(machine.scs.due(Masks::default()), None);
        machine.read(PLACE + 4, 4);
        machine.settle();
        assert_eq!(machine.read(FLASH + ECCR, 4), 1 << 31 | 1 << 21 | 0x3_f010);
        for _ in 0..2 {
            assert_eq!(machine.scs.due(Masks { primask: true, ..Masks::default() }), Some(NMI));
            machine.scs.enter(NMI);
            machine.settle();
            machine.scs.leave();
            machine.settle();
        }
        machine.scs.enter(NMI);
        machine.write(FLASH + ECCR, 4, 1 << 31);
        machine.settle();
        machine.scs.leave();
        machine.settle();
        assert_eq!(machine.scs.due(Masks::default()), None);
        assert_eq!(machine.wires.violations.all(), []);
    }
}

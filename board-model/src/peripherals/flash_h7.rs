//! Flash controller of STM32H743: RM0433 section 4. Two banks with their own registers, words of 256 bits with check
//! bits, collected in a buffer before they are programmed.

use super::Peripheral;
use super::flash::{ACR, Array, BASE, Lock, Work};
use crate::register::{Register, Registers, bit};
use crate::wires::{MICROSECOND, Operation, Time, Wires};

const KEYR: u32 = 0x04;
const CR: u32 = 0x0c;
const SR: u32 = 0x10;
const CCR: u32 = 0x14;
const ECC_FA: u32 = 0x60;
/// Offset from the first bank's registers to the second bank's.
const SECOND: u32 = 0x100;
/// 2 MiB in two banks.
const SIZE: u32 = 0x20_0000;
const BANK: u32 = SIZE / 2;
const SECTOR: u32 = 0x2_0000;
const WORD: u32 = 32;
const ERRORS: u32 = 0x17ee_0000;
const FLAGS: u32 = 0x1fef_0000;

/// RM0433 4.9.
static MAP: [Register; 14] = [
    Register::new("FLASH_ACR", ACR, 0x37, 0x3f),
    Register::new("FLASH_KEYR1", KEYR, 0, u32::MAX).special(u32::MAX).any_value(),
    Register::new("FLASH_OPTKEYR", 0x08, 0, u32::MAX).special(u32::MAX).any_value(),
    Register::new("FLASH_CR1", CR, 0x31, 0x1fef_87ff).special(u32::MAX),
    Register::new("FLASH_SR1", SR, 0, 0x1fef_000f).special(u32::MAX),
    Register::new("FLASH_CCR1", CCR, 0, FLAGS).special(u32::MAX),
    Register::new("FLASH_OPTCR", 0x18, 1, 0xc000_0013).special(u32::MAX),
    Register::new("FLASH_OPTSR_CUR", 0x1c, 0x1bc6_aaf0, u32::MAX).special(u32::MAX),
    Register::new("FLASH_ECC_FA1", ECC_FA, 0, 0x7fff).special(u32::MAX),
    Register::new("FLASH_KEYR2", SECOND + KEYR, 0, u32::MAX).special(u32::MAX).any_value(),
    Register::new("FLASH_CR2", SECOND + CR, 0x31, 0x1fef_87ff).special(u32::MAX),
    Register::new("FLASH_SR2", SECOND + SR, 0, 0x1fef_000f).special(u32::MAX),
    Register::new("FLASH_CCR2", SECOND + CCR, 0, FLAGS).special(u32::MAX),
    Register::new("FLASH_ECC_FA2", SECOND + ECC_FA, 0, 0x7fff).special(u32::MAX),
];

/// Data sheet of STM32H743, table 53: 1 s per sector by double words, 100 us per 256 bits.
const ERASE: Time = 1_000_000 * MICROSECOND;
const PROGRAM: Time = 100 * MICROSECOND;

/// RM0433 table 17: highest bus clock by voltage scale, with the minimum number of wait states and minimum WRHIGHFREQ
/// [MHz].
const SPEEDS: [&[(u64, u32, u32)]; 3] = [
    &[(70, 0, 0), (140, 1, 1), (185, 2, 1), (210, 2, 2), (225, 3, 2)],
    &[(55, 0, 0), (110, 1, 1), (165, 2, 1), (225, 3, 2)],
    &[(45, 0, 0), (90, 1, 1), (135, 2, 1), (180, 3, 2), (225, 4, 2)],
];

/// State of a bank.
#[derive(Debug, Clone, Default)]
struct Bank {
    lock: Lock,
    work: Work,
    /// Address of the word being collected, and its 32-bit parts written so far.
    gathered: Option<(u32, [Option<u32>; 8])>,
}

/// Flash controller.
#[derive(Debug)]
pub struct Flash {
    registers: Registers,
    array: Array,
    banks: [Bank; 2],
}

impl Flash {
    /// Controller with an image that ends at an address.
    pub fn new(image_end: u32) -> Self {
        Self {
            registers: Registers::new(&MAP),
            array: Array::new(image_end, SIZE, WORD, true),
            banks: Default::default(),
        }
    }

    fn control_written(&mut self, bank: usize, value: u32, before: u32, wires: &mut Wires) {
        let control = bank as u32 * SECOND + CR;
        let programs = before & bit(1) != 0 && value & bit(1) == 0;
        if programs && !wires.barrier {
            // RM0433 4.3.9 with ARMv7-M A3.7.3: a store may still be pending when the next register is written.
            let what = "PG is cleared with no DSB after the stores to flash";
            wires.violation("FLASH_CR", what, "RM0433 4.3.9, ARMv7-M A3.7.3");
        }
        if programs && self.banks[bank].gathered.take().is_some() {
            wires.violation("FLASH_CR", "PG is cleared while a word is incomplete", "RM0433 4.3.9 INCERR");
        }
        if value & 1 == 1 {
            self.banks[bank].lock = Lock::default();
            self.registers.change(control, 1, 0);
            return;
        }
        if self.banks[bank].lock != Lock::Open {
            wires.violation("FLASH_CR", "is written while locked: the keys first", "RM0433 4.5.1");
            return;
        }
        if self.banks[bank].work.goes_on(wires) {
            wires.violation("FLASH_CR", "is written while the bank is at work", "RM0433 4.9.4");
        }
        self.registers.set(control, value & !bit(7));
        if value & bit(7) != 0 {
            self.erase(bank, value, wires);
        }
    }

    fn erase(&mut self, bank: usize, control: u32, wires: &mut Wires) {
        if control & (bit(1) | bit(2) | bit(3)) != bit(2) {
            wires.violation("FLASH_CR", "starts an erase of no sector, or of more", "RM0433 4.3.10");
            return;
        }
        let first = BASE + BANK * bank as u32 + SECTOR * (control >> 8 & 7);
        if let Some(how_far) = wires.begins_flash_operation(Operation::Erase) {
            self.array.leave_erased(first, SECTOR, how_far, wires);
            return;
        }
        self.array.erase(first, SECTOR, wires);
        self.work(bank, ERASE, wires);
    }

    fn work(&mut self, bank: usize, duration: Time, wires: &mut Wires) {
        self.banks[bank].work.begin(duration, wires);
        if bank == 0 {
            wires.stall += duration;
        }
    }

    fn gather(&mut self, bank: usize, address: u32, value: u32, wires: &mut Wires) {
        let first = address / WORD * WORD;
        let (start, mut words) = self.banks[bank].gathered.take().unwrap_or((first, [None; 8]));
        if start != first {
            self.registers.change(bank as u32 * SECOND + SR, bit(21), 0);
            wires.violation("flash", "another word is begun before the one before is full", "RM0433 4.3.9 INCERR");
            return;
        }
        words[(address - first) as usize / 4] = Some(value);
        if words.iter().any(Option::is_none) {
            self.banks[bank].gathered = Some((first, words));
            return;
        }
        if !self.array.is_erased(first) {
            wires.violation("flash", "is programmed over what is not erased", "RM0433 4.3.9");
        }
        let cut = wires.begins_flash_operation(Operation::Program);
        for (word, place) in words.iter().flatten().zip((first..).step_by(4)) {
            match cut {
                Some(how_far) => self.array.leave_programmed(place, 4, u64::from(*word), how_far),
                None => self.array.program(place, 4, u64::from(*word)),
            }
        }
        if cut.is_some() {
            return;
        }
        self.work(bank, PROGRAM, wires);
    }
}

fn bank_of(address: u32) -> usize {
    usize::from(address >= BASE + BANK)
}

impl Peripheral for Flash {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        wires.waiting = offset % SECOND == SR && self.banks[(offset >= SECOND) as usize].work.goes_on(wires);
        self.registers.get(offset)
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        let (bank, register) = ((offset >= SECOND) as usize, offset % SECOND);
        match register {
            ACR => {}
            KEYR => self.banks[bank].lock.key(value, "FLASH_KEYR", wires),
            CR => self.control_written(bank, value, before, wires),
            CCR => self.registers.change(bank as u32 * SECOND + SR, 0, value & FLAGS),
            _ => wires.violation("FLASH", "option bytes are not modelled and not to be touched", "RM0433 4.4"),
        }
        if self.banks[bank].lock == Lock::Open {
            self.registers.change(bank as u32 * SECOND + CR, 0, 1);
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        for bank in 0..2 {
            let busy = u32::from(self.banks[bank].work.goes_on(wires));
            let waits = u32::from(self.banks[bank].gathered.is_some());
            // BSY, WBNE, QW.
            self.registers.change(bank as u32 * SECOND + SR, busy | waits << 1 | busy << 2, 7);
        }
        let (waits, signal) = (self.registers.field(ACR, 0, 4), self.registers.field(ACR, 4, 2));
        let table = SPEEDS[(wires.voltage as usize).clamp(1, 3) - 1];
        let most =
            table.iter().filter(|(_, least, high)| *least <= waits && *high <= signal).map(|(most, ..)| most).max();
        let most = most.copied().unwrap_or(0) * 1_000_000;
        if wires.clocks.bus > most {
            let what = format!(
                "{waits} wait states with WRHIGHFREQ {signal} at scale {} are too few for {} Hz",
                wires.voltage, wires.clocks.bus
            );
            wires.violation("FLASH_ACR", what, "RM0433 4.3.8, table 17");
        }
    }

    fn reset(&mut self) {
        self.registers.reset();
        self.banks = Default::default();
    }

    fn read_memory(&mut self, address: u32, size: u32, wires: &mut Wires) -> Option<u64> {
        if !self.array.holds(address) {
            return None;
        }
        let bank = bank_of(address);
        if self.array.is_damaged(address) {
            // RM0433 4.7.3: a two-bit error is a bus error; the register keeps the address of the first one.
            let offset = bank as u32 * SECOND;
            if !self.registers.is_set(offset + SR, 26) {
                self.registers.set(offset + ECC_FA, (address - BASE) % BANK / WORD);
            }
            self.registers.change(offset + SR, bit(26), 0);
            wires.bus_fault = Some(address);
        }
        wires.stall += self.banks[bank].work.left(wires);
        Some(self.array.read(address, size))
    }

    fn write_memory(&mut self, address: u32, size: u32, value: u64, wires: &mut Wires) -> bool {
        if !self.array.holds(address) {
            return false;
        }
        let bank = bank_of(address);
        let offset = bank as u32 * SECOND;
        wires.barrier = false;
        let (error, what, section) = if !self.registers.is_set(offset + CR, 1) || self.banks[bank].lock != Lock::Open {
            (bit(18), "is written while PG is 0", "RM0433 4.3.9 PGSERR")
        } else if self.registers.get(offset + SR) & ERRORS != 0 {
            (bit(18), "is written while an error flag is up", "RM0433 4.3.9 PGSERR")
        } else if size != 4 {
            (bit(21), "only words are modelled", "RM0433 4.3.9")
        } else {
            (0, "", "")
        };
        if error != 0 {
            self.registers.change(offset + SR, error, 0);
            wires.violation("flash", what, section);
            return true;
        }
        // A write to a busy bank waits on the bus.
        wires.stall += self.banks[bank].work.left(wires);
        self.gather(bank, address, value as u32, wires);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::KEYS;
    use crate::scs::{HARD_FAULT, Masks};
    use crate::wires::{Cable, Cut, HowFar, Reset, Surroundings};

    const FLASH: u32 = 0x5200_2000 + SECOND;
    const PLACE: u32 = BASE + BANK + 0x40;

    /// A read with FAULTMASK survives it.
    #[test]
    fn cut_word_is_bus_fault() {
        let mut machine =
            Machine::new(chips::h743::chip(BASE + 0x1000), Surroundings::default(), Cable::default(), 1000);
        machine.settle();
        machine.wires.cut = Some(Cut { operation: 0, how_far: HowFar::Middle });
        KEYS.into_iter().for_each(|key| machine.write(FLASH + KEYR, 4, key.into()));
        machine.write(FLASH + CR, 4, 0x32);
        (0..8).for_each(|word| machine.write(PLACE + 4 * word, 4, 0x1234));
        assert_eq!(machine.wires.reset.take(), Some(Reset::Power));
        machine.reset(Reset::Power);
        machine.settle();
        // BFHFNMIGN.
        machine.write(0xe000_ed14, 4, 0x300);
        machine.read(PLACE + 12, 4);
        machine.scs.ignore_bus_fault(true, &mut machine.wires);
        machine.settle();
        assert_eq!(machine.scs.due(Masks::default()), None);
        assert_eq!((machine.read(0xe000_ed28, 4), machine.read(0xe000_ed38, 4)), (0x8200, u64::from(PLACE + 12)));
        assert_eq!((machine.read(FLASH + SR, 4), machine.read(FLASH + ECC_FA, 4)), (1 << 26, 2));
        machine.write(FLASH + CCR, 4, 1 << 26);
        assert_eq!(machine.read(FLASH + SR, 4), 0);
        machine.read(PLACE, 4);
        machine.settle();
        assert_eq!(machine.scs.due(Masks::default()), Some(HARD_FAULT));
        assert_eq!(machine.wires.violations.all(), []);
    }
}

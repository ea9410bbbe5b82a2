//! Flash controller of STM32F405: RM0090 section 3. Single bank: reads during an operation wait for its end.

use super::Peripheral;
use super::flash::{ACR, Array, BASE, Caches, Lock, Work};
use crate::register::{Register, Registers, bit};
use crate::wires::{MICROSECOND, Operation, Time, Wires};

const KEYR: u32 = 0x04;
const SR: u32 = 0x0c;
const CR: u32 = 0x10;
/// One mebibyte.
const SIZE: u32 = 0x10_0000;
const KIB: u32 = 1024;

/// RM0090 3.9.
static MAP: [Register; 6] = [
    Register::new("FLASH_ACR", ACR, 0, 0x1f07).special(Caches::SPECIAL),
    Register::new("FLASH_KEYR", KEYR, 0, u32::MAX).special(u32::MAX).any_value(),
    Register::new("FLASH_OPTKEYR", 0x08, 0, u32::MAX).special(u32::MAX).any_value(),
    Register::new("FLASH_SR", SR, 0, 0x0001_00f3).special(0x0001_00f3),
    Register::new("FLASH_CR", CR, 0x8000_0000, 0x8301_037f).special(0x8301_037f),
    Register::new("FLASH_OPTCR", 0x14, 0x0fff_aaed, 0x0fff_ffef).special(u32::MAX),
];

/// Data sheet of STM32F405, table 40: erasing a 128 KiB sector by words takes 1 s (2 s at most), smaller sectors less;
/// a word takes 16 us.
const ERASE_PER_KIB: Time = 7800 * MICROSECOND;
const PROGRAM: Time = 16 * MICROSECOND;
/// RM0090 table 10, 2.7 to 3.6 V: one wait state per 30 MHz.
const PER_WAIT_STATE: u64 = 30_000_000;

/// Flash controller.
#[derive(Debug)]
pub struct Flash {
    registers: Registers,
    array: Array,
    lock: Lock,
    work: Work,
    caches: Caches,
}

impl Flash {
    /// Controller with an image that ends at an address.
    pub fn new(image_end: u32) -> Self {
        Self {
            registers: Registers::new(&MAP),
            array: Array::new(image_end, SIZE, 4, false),
            lock: Lock::default(),
            work: Work::default(),
            caches: Caches::new(["RM0090 3.9.1", "RM0090 3.5.2"], false),
        }
    }

    fn work(&mut self, duration: Time, wires: &mut Wires) {
        self.work.begin(duration, wires);
        // RM0090 3.6: reads of flash, including instructions, wait for the end.
        wires.stall += duration;
        self.caches.flash_changes(&self.registers);
    }

    fn control_written(&mut self, value: u32, before: u32, wires: &mut Wires) {
        if value & bit(31) != 0 {
            self.lock = Lock::default();
            self.registers.set(CR, bit(31));
            return;
        }
        if self.lock != Lock::Open {
            wires.violation("FLASH_CR", "is written while locked: the keys first", "RM0090 3.6.1");
            return;
        }
        if self.work.goes_on(wires) {
            wires.violation("FLASH_CR", "is written while BSY is 1", "RM0090 3.9.5");
        }
        if value & bit(16) != 0 && value & 0x7f != before & 0x7f {
            wires.violation("FLASH_CR", "the kind of erase is chosen with its start, not before", "RM0090 3.6.3");
        }
        self.registers.set(CR, value & !bit(16));
        if value & bit(16) != 0 {
            self.erase(value, wires);
        }
    }

    fn erase(&mut self, control: u32, wires: &mut Wires) {
        let sector = control >> 3 & 0xf;
        if control & bit(1) == 0 || sector > 11 {
            wires.violation("FLASH_CR", "starts an erase of no sector", "RM0090 3.6.3");
            return;
        }
        // RM0090 table 5.
        let (first, size) = match sector {
            0..4 => (sector * 16 * KIB, 16 * KIB),
            4 => (64 * KIB, 64 * KIB),
            _ => ((sector - 4) * 128 * KIB, 128 * KIB),
        };
        if let Some(how_far) = wires.begins_flash_operation(Operation::Erase) {
            self.array.leave_erased(BASE + first, size, how_far, wires);
            return;
        }
        self.array.erase(BASE + first, size, wires);
        self.work(ERASE_PER_KIB * u64::from(size / KIB), wires);
    }
}

impl Peripheral for Flash {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            ACR => self.caches.written(value, &mut self.registers, wires),
            KEYR => self.lock.key(value, "FLASH_KEYR", wires),
            SR => self.registers.change(SR, 0, value & 0xf3),
            CR => self.control_written(value, before, wires),
            _ => wires.violation("FLASH", "option bytes are not modelled and not to be touched", "RM0090 3.7"),
        }
        if self.lock == Lock::Open {
            self.registers.change(CR, 0, bit(31));
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let busy = self.work.goes_on(wires);
        self.registers.change(SR, u32::from(busy) << 16, bit(16));
        let waits = u64::from(self.registers.field(ACR, 0, 3));
        if wires.clocks.bus > (waits + 1) * PER_WAIT_STATE {
            let what = format!("{waits} wait states are too few for {} Hz", wires.clocks.bus);
            wires.violation("FLASH_ACR", what, "RM0090 3.5.1, table 10");
        }
    }

    fn reset(&mut self) {
        self.registers.reset();
        self.lock = Lock::default();
        self.work = Work::default();
        self.caches.reset();
    }

    fn read_memory(&mut self, address: u32, size: u32, wires: &mut Wires) -> Option<u64> {
        if !self.array.holds(address) {
            return None;
        }
        self.caches.flash_is_read(&self.registers, wires);
        Some(self.array.read(address, size))
    }

    fn write_memory(&mut self, address: u32, size: u32, value: u64, wires: &mut Wires) -> bool {
        if !self.array.holds(address) {
            return false;
        }
        let parallelism = 1 << self.registers.field(CR, 8, 2);
        let (error, what, section) = if !self.registers.is_set(CR, 0) || self.lock != Lock::Open {
            (bit(7), "is written while PG is 0", "RM0090 3.6.4 PGSERR")
        } else if parallelism != size {
            (bit(6), "is written with another width than PSIZE says", "RM0090 3.6.4 PGPERR")
        } else if address / 16 != (address + size - 1) / 16 {
            (bit(5), "a write crosses 128 bits", "RM0090 3.6.4 PGAERR")
        } else if self.work.goes_on(wires) {
            (bit(7), "is written while BSY is 1", "RM0090 3.6.4")
        } else if self.registers.get(SR) & 0xf2 != 0 {
            (bit(7), "is written while an error flag is up", "RM0090 3.9.4")
        } else {
            (0, "", "")
        };
        if error != 0 {
            self.registers.change(SR, error, 0);
            wires.violation("flash", what, section);
            return true;
        }
        let held = self.array.read(address, size);
        if held & value != value {
            wires.violation("flash", "is programmed over what is not erased", "RM0090 3.6.4");
        }
        if let Some(how_far) = wires.begins_flash_operation(Operation::Program) {
            // The F405 has no check bits: damaged words cannot be told from good ones.
            self.array.leave_programmed(address, size, value, how_far);
            return true;
        }
        self.array.program(address, size, value);
        self.work(PROGRAM, wires);
        true
    }
}

//! Power control of STM32G474 and STM32G431: RM0440 section 6. Range of the regulator, and its boost.

use super::Peripheral;
use super::pvd::Detector;
use crate::register::{Register, Registers, bit};
use crate::wires::Wires;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const CR3: u32 = 0x08;
const SR2: u32 = 0x14;
const CR5: u32 = 0x80;

/// RM0440 6.4.
static MAP: [Register; 8] = [
    Register::new("PWR_CR1", CR1, 0x0200, 0x4707),
    Register::new("PWR_CR2", CR2, 0, 0xff),
    Register::new("PWR_CR3", CR3, 0x8000, 0xe51f),
    Register::new("PWR_CR4", 0x0c, 0, 0x031f),
    Register::new("PWR_SR1", 0x10, 0, 0x811f).special(u32::MAX),
    Register::new("PWR_SR2", SR2, 0, 0xff00).special(u32::MAX),
    Register::new("PWR_SCR", 0x18, 0, 0x011f).special(u32::MAX),
    Register::new("PWR_CR5", CR5, 0x0100, 0x0100),
];

/// Data sheet of STM32G474, section 5.3.4.
const DETECTOR: Detector = Detector {
    enable: (CR2, 0),
    level: (CR2, 1),
    output: (SR2, 11),
    levels: [2050, 2200, 2360, 2520, 2640, 2810, 2900, 0],
};

/// Power control.
#[derive(Debug)]
pub struct Pwr {
    registers: Registers,
}

impl Default for Pwr {
    fn default() -> Self {
        Self { registers: Registers::new(&MAP) }
    }
}

impl Peripheral for Pwr {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        let range = self.registers.field(CR1, 9, 2);
        if offset == CR1 && !matches!(range, 1 | 2) {
            wires.violation("PWR_CR1", format!("VOS {range} is no range"), "RM0440 6.4.1");
        }
        // RM0440 6.1.5: the bus clock must be halved before boost is switched on, so that it is at most 85 MHz.
        let boosts = offset == CR5 && before & bit(8) != 0 && value & bit(8) == 0;
        if boosts && wires.clocks.core > wires.clocks.system / 2 {
            let what = "boost is switched on while the bus clock is not halved";
            wires.violation("PWR_CR5", what, "RM0440 6.1.5");
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        DETECTOR.watch(&mut self.registers, wires);
        wires.voltage = self.registers.field(CR1, 9, 2);
        // UCPD1_DBDIS: RM0440 6.4.3.
        wires.pulls_down_for_usb = !self.registers.is_set(CR3, 14);
        wires.boost = !self.registers.is_set(CR5, 8);
        let most = match (wires.voltage, wires.boost) {
            (2, _) => 26_000_000,
            (_, false) => 150_000_000,
            (_, true) => 170_000_000,
        };
        if wires.clocks.core > most {
            let what = format!("the core runs at {} Hz: this range allows {most}", wires.clocks.core);
            wires.violation("PWR_CR5", what, "RM0440 6.1.5");
        }
    }
}

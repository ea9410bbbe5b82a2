//! Power control of STM32F405: RM0090 section 5. After a reset the regulator is at scale 1, which 168 MHz require.

use super::Peripheral;
use super::pvd::Detector;
use crate::register::{Register, Registers, bit};
use crate::wires::Wires;

const CR: u32 = 0x00;
const CSR: u32 = 0x04;

/// RM0090 5.4.
static MAP: [Register; 2] =
    [Register::new("PWR_CR", CR, 0x4000, 0x43ff), Register::new("PWR_CSR", CSR, 0x4000, 0x430f).special(0x400f)];

/// Data sheet of STM32F405, table 18.
const DETECTOR: Detector = Detector {
    enable: (CR, 4),
    level: (CR, 5),
    output: (CSR, 2),
    levels: [2040, 2190, 2350, 2510, 2660, 2820, 2930, 3030],
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

    fn advance(&mut self, wires: &mut Wires) {
        DETECTOR.watch(&mut self.registers, wires);
        // RM0090 5.1.3: at most 144 MHz at scale 2.
        if self.registers.get(CR) & bit(14) == 0 && wires.clocks.core > 144_000_000 {
            wires.violation("PWR_CR", "scale 2 is too low for more than 144 MHz", "RM0090 5.1.3");
        }
    }
}

//! Power control of STM32F405: RM0090 section 5. The regulator is at scale 1 after a reset, which 168 MHz need.

use super::Peripheral;
use crate::register::{Register, Registers, bit};
use crate::wires::Wires;

/// RM0090 5.4.
static MAP: [Register; 2] =
    [Register::new("PWR_CR", 0x00, 0x4000, 0x43ff), Register::new("PWR_CSR", 0x04, 0x4000, 0x430f).special(0x400f)];

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
        // RM0090 5.1.3: 144 MHz at scale 2.
        if self.registers.get(0) & bit(14) == 0 && wires.clocks.core > 144_000_000 {
            wires.violation("PWR_CR", "scale 2 is too low for more than 144 MHz", "RM0090 5.1.3");
        }
    }
}

//! System configuration: RM0090 section 9, RM0440 section 10. Only which port is behind an external interrupt line.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::Wires;

const EXTICR1: u32 = 0x08;

static MAP: [Register; 6] = [
    Register::new("SYSCFG_MEMRMP", 0x00, 0, 0x0000_0107),
    Register::new("SYSCFG_PMC", 0x04, 0, 0x0080_0000),
    Register::new("SYSCFG_EXTICR1", EXTICR1, 0, 0xffff),
    Register::new("SYSCFG_EXTICR2", EXTICR1 + 4, 0, 0xffff),
    Register::new("SYSCFG_EXTICR3", EXTICR1 + 8, 0, 0xffff),
    Register::new("SYSCFG_EXTICR4", EXTICR1 + 12, 0, 0xffff),
];

/// System configuration.
#[derive(Debug)]
pub struct Syscfg {
    registers: Registers,
}

impl Default for Syscfg {
    fn default() -> Self {
        Self { registers: Registers::new(&MAP) }
    }
}

impl Peripheral for Syscfg {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, _offset: u32, _value: u32, _before: u32, wires: &mut Wires) {
        for line in 0..16u32 {
            let port = self.registers.field(EXTICR1 + line / 4 * 4, line % 4 * 4, 4);
            wires.line_ports[line as usize] = char::from_u32('A' as u32 + port).unwrap_or('A');
        }
    }
}

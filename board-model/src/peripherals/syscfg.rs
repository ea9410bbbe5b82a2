//! System configuration: RM0090 section 9, RM0440 section 10. Only the ports of external interrupt lines are modelled.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::Wires;

const EXTICR1: u32 = 0x08;

/// RM0090 9.2, as far as the STM32F405 has it; RM0440 10.2.
static F4: [Register; 6] = map([("SYSCFG_MEMRMP", 0, 0x3), ("SYSCFG_PMC", 0, 0x0080_0000)]);
static G4: [Register; 6] = map([("SYSCFG_MEMRMP", 0, 0x0107), ("SYSCFG_CFGR1", 0x7c00_0001, 0xfcff_0300)]);

/// Register map, with names, reset values and fields of the two registers that differ.
const fn map(first: [(&'static str, u32, u32); 2]) -> [Register; 6] {
    let [(memory, memory_reset, memory_fields), (other, other_reset, other_fields)] = first;
    [
        Register::new(memory, 0x00, memory_reset, memory_fields),
        Register::new(other, 0x04, other_reset, other_fields),
        Register::new("SYSCFG_EXTICR1", EXTICR1, 0, 0xffff),
        Register::new("SYSCFG_EXTICR2", EXTICR1 + 4, 0, 0xffff),
        Register::new("SYSCFG_EXTICR3", EXTICR1 + 8, 0, 0xffff),
        Register::new("SYSCFG_EXTICR4", EXTICR1 + 12, 0, 0xffff),
    ]
}

/// System configuration.
#[derive(Debug)]
pub struct Syscfg {
    registers: Registers,
}

impl Syscfg {
    /// Registers of the STM32F405.
    pub fn f4() -> Self {
        Self { registers: Registers::new(&F4) }
    }

    /// Registers of the STM32G474.
    pub fn g4() -> Self {
        Self { registers: Registers::new(&G4) }
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

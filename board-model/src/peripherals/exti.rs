//! External interrupts: RM0090 section 12, RM0440 section 15. Only lines 0 to 15 (pins) are modelled.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::{Pin, Wires};

/// RM0090 12.3: lines 0 to 22.
static F4: [Register; 6] = [
    Register::new("EXTI_IMR", 0x00, 0, 0x007f_ffff),
    Register::new("EXTI_EMR", 0x04, 0, 0x007f_ffff),
    Register::new("EXTI_RTSR", 0x08, 0, 0x007f_ffff),
    Register::new("EXTI_FTSR", 0x0c, 0, 0x007f_ffff),
    Register::new("EXTI_SWIER", 0x10, 0, 0x007f_ffff),
    Register::new("EXTI_PR", 0x14, 0, 0x007f_ffff).special(0x007f_ffff),
];
/// RM0440 15.5: lines 0 to 31 in the first set.
static G4: [Register; 6] = [
    Register::new("EXTI_IMR1", 0x00, 0x1f84_0000, u32::MAX),
    Register::new("EXTI_EMR1", 0x04, 0, u32::MAX),
    Register::new("EXTI_RTSR1", 0x08, 0, 0xe07b_ffff),
    Register::new("EXTI_FTSR1", 0x0c, 0, 0xe07b_ffff),
    Register::new("EXTI_SWIER1", 0x10, 0, 0xe07b_ffff),
    Register::new("EXTI_PR1", 0x14, 0, 0xe07b_ffff).special(0xe07b_ffff),
];

const IMR: u32 = 0x00;
const RTSR: u32 = 0x08;
const FTSR: u32 = 0x0c;
const PR: u32 = 0x14;

/// Interrupts of lines 0 to 15, equal on both chips: 0 to 4 single, then two groups.
const INTERRUPTS: [(u32, usize); 7] = [(0x1, 6), (0x2, 7), (0x4, 8), (0x8, 9), (0x10, 10), (0x3e0, 23), (0xfc00, 40)];

/// External interrupts.
#[derive(Debug)]
pub struct Exti {
    registers: Registers,
    levels: [bool; 16],
}

impl Exti {
    /// Controller of the STM32F405.
    pub fn f4() -> Self {
        Self { registers: Registers::new(&F4), levels: [false; 16] }
    }

    /// Controller of the STM32G474.
    pub fn g4() -> Self {
        Self { registers: Registers::new(&G4), levels: [false; 16] }
    }
}

impl Peripheral for Exti {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, offset: u32, value: u32, _before: u32, wires: &mut Wires) {
        if offset == PR {
            // RM0090 12.3.6: writing ones clears.
            self.registers.change(PR, 0, value);
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let watched = self.registers.get(RTSR) | self.registers.get(FTSR);
        for line in (0..16).filter(|line| watched >> line & 1 == 1) {
            let level = wires.level(Pin(wires.line_ports[line as usize], line));
            let before = std::mem::replace(&mut self.levels[line as usize], level);
            let rose = level && !before && self.registers.is_set(RTSR, line);
            let fell = !level && before && self.registers.is_set(FTSR, line);
            if rose || fell {
                self.registers.change(PR, 1 << line, 0);
            }
        }
        let asked = self.registers.get(PR) & self.registers.get(IMR);
        for (lines, interrupt) in INTERRUPTS {
            wires.interrupt(interrupt, asked & lines != 0);
        }
    }
}

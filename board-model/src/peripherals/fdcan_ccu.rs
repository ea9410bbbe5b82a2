//! Clock calibration of the FDCAN of STM32H743: RM0433 56. Only its bypass is modelled.

use super::Peripheral;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::Wires;

const CCFG: u32 = 0x04;

static TABLE: [Register; 6] = [
    Register::new("FDCAN_CCU_CREL", 0x00, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_CCU_CCFG", CCFG, 4, bits(4, 0) | bits(19, 6) | bit(31)),
    Register::new("FDCAN_CCU_CSTAT", 0x08, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_CCU_CWD", 0x0c, 0, 0xffff),
    Register::new("FDCAN_CCU_IR", 0x10, 0, 3).special(3),
    Register::new("FDCAN_CCU_IE", 0x14, 0, 3),
];

/// Clock calibration unit.
#[derive(Debug)]
pub struct Calibration(Registers);

impl Default for Calibration {
    fn default() -> Self {
        Self(Registers::new(&TABLE))
    }
}

impl Peripheral for Calibration {
    fn registers(&mut self) -> &mut Registers {
        &mut self.0
    }

    fn written(&mut self, offset: u32, _: u32, _: u32, wires: &mut Wires) {
        if !wires.fdcan.is_open {
            let what = format!("register {offset:#x} is written while INIT and CCE of FDCAN1 are not both 1");
            wires.violation("FDCAN_CCU", what, "RM0433 56, clock calibration");
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let divider = u64::from(self.0.field(CCFG, 16, 4));
        wires.fdcan.divider = self.0.is_set(CCFG, 6).then_some(if divider == 0 { 1 } else { 2 * divider });
    }
}

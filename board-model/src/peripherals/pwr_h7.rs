//! Power control of STM32H743: RM0433 section 6. The supply is configured first, once after power-up; only then may the
//! voltage scale change.

use super::Peripheral;
use super::pvd::Detector;
use crate::register::{Register, Registers, bit};
use crate::wires::{MICROSECOND, Time, Wires};

const CR1: u32 = 0x00;
const CSR1: u32 = 0x04;
const CR3: u32 = 0x0c;
const D3CR: u32 = 0x18;

/// RM0433 6.8.
static MAP: [Register; 8] = [
    Register::new("PWR_CR1", CR1, 0xf000_c000, 0x0007_c3f1),
    Register::new("PWR_CSR1", CSR1, 0x4000, 0x0001_e010).special(u32::MAX),
    Register::new("PWR_CR2", 0x08, 0, 0x00f1_0011).special(0x00f1_0000),
    Register::new("PWR_CR3", CR3, 0x06, 0x0700_0307).special(bit(26)),
    Register::new("PWR_CPUCR", 0x10, 0, 0x0000_0be7),
    Register::new("PWR_D3CR", D3CR, 0x4000, 0x0000_e000).special(bit(13)),
    Register::new("PWR_WKUPCR", 0x20, 0, 0x3f).special(0x3f),
    Register::new("PWR_WKUPFR", 0x24, 0, 0x3f).special(0x3f),
];

/// Data sheet of STM32H743, section 6.3.4.
const DETECTOR: Detector = Detector {
    enable: (CR1, 4),
    level: (CR1, 5),
    output: (CSR1, 4),
    levels: [1910, 2050, 2190, 2350, 2500, 2650, 2800, 0],
};

/// Settling time of a new scale.
const SETTLES: Time = 10 * MICROSECOND;

/// Power control.
#[derive(Debug)]
pub struct Pwr {
    registers: Registers,
    /// Time at which the configured supply is stable; `None` before it is configured.
    supplied: Option<Time>,
    scale_at: Time,
}

impl Default for Pwr {
    fn default() -> Self {
        Self { registers: Registers::new(&MAP), supplied: None, scale_at: 0 }
    }
}

impl Peripheral for Pwr {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            CR3 => {
                // NUCLEO-H743ZI is supplied through the regulator.
                if value & 7 != 0b110 {
                    wires.violation(
                        "PWR_CR3",
                        "the board is supplied by the regulator: LDOEN 1, BYPASS 0",
                        "RM0433 6.4.1",
                    );
                }
                self.supplied.get_or_insert(wires.now + SETTLES);
            }
            D3CR if value & 0xc000 != before & 0xc000 => {
                if self.supplied.is_none_or(|ready| ready > wires.now) {
                    wires.violation("PWR_D3CR", "the scale is changed before the supply is set up", "RM0433 6.6.2");
                }
                if value & 0xc000 == 0 {
                    wires.violation("PWR_D3CR", "VOS 0 is reserved", "RM0433 6.8.6");
                }
                self.scale_at = wires.now + SETTLES;
            }
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let ready = self.scale_at <= wires.now;
        let supplied = self.supplied.is_some_and(|ready| ready <= wires.now);
        let scale = self.registers.field(D3CR, 14, 2);
        self.registers.change(D3CR, u32::from(ready) << 13, bit(13));
        let active = if ready { scale } else { self.registers.field(CSR1, 14, 2) };
        self.registers.set(CSR1, active << 14 | u32::from(supplied && ready) << 13);
        DETECTOR.watch(&mut self.registers, wires);
        // VOS 3 is scale 1, the fastest.
        wires.voltage = 4 - active;
    }

    /// RM0433 6.8.4: the configuration of the supply persists until a loss of power.
    fn reset(&mut self) {
        let supplied = self.supplied;
        *self = Self { supplied, ..Self::default() };
    }

    fn power_lost(&mut self) {
        self.supplied = None;
    }
}

//! Debug unit: RM0090 38.16, RM0440 47.16, RM0433 60.5.8. Of all peripherals that it can freeze, only the independent
//! watchdog is modelled. Its registers survive a reset of the chip and are cleared by power-up only.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::Wires;

static F405: [Register; 4] = [
    Register::new("DBGMCU_IDCODE", 0x00, 0x1000_0413, 0).special(u32::MAX),
    Register::new("DBGMCU_CR", 0x04, 0, 0xe7),
    Register::new("DBGMCU_APB1_FZ", 0x08, 0, 0x06e0_1dff),
    Register::new("DBGMCU_APB2_FZ", 0x0c, 0, 0x0007_0003),
];
static G474: [Register; 5] = g4(0x2003_6469, [0xc060_1c3f, 0x2, 0x0417_2800]);
/// G474 without TIM5, I2C4, TIM20 and HRTIM.
static G431: [Register; 5] = g4(0x2003_6468, [0xc060_1c37, 0, 0x0007_2800]);
static H743: [Register; 7] = [
    Register::new("DBGMCU_IDC", 0x00, 0x2003_6450, 0).special(u32::MAX),
    Register::new("DBGMCU_CR", 0x04, 0, 0x1070_0007),
    Register::new("DBGMCU_APB3FZ1", 0x34, 0, 0x40),
    Register::new("DBGMCU_APB1LFZ1", 0x3c, 0, 0x00e0_03ff),
    Register::new("DBGMCU_APB1HFZ1", 0x44, 0, 0x0100),
    Register::new("DBGMCU_APB2FZ1", 0x4c, 0, 0x2007_0003),
    Register::new("DBGMCU_APB4FZ1", 0x54, 0, 0x0005_1e80),
];

/// Register map of the chips of RM0440, with their identity and freeze bits.
const fn g4(identity: u32, [low, low_2, high]: [u32; 3]) -> [Register; 5] {
    [
        Register::new("DBGMCU_IDCODE", 0x00, identity, 0).special(u32::MAX),
        Register::new("DBGMCU_CR", 0x04, 0, 0xe7),
        Register::new("DBGMCU_APB1FZR1", 0x08, 0, low),
        Register::new("DBGMCU_APB1FZR2", 0x0c, 0, low_2),
        Register::new("DBGMCU_APB2FZR", 0x10, 0, high),
    ]
}

/// Debug unit, with register and bit that freeze the independent watchdog.
#[derive(Debug)]
pub struct Dbgmcu {
    registers: Registers,
    watchdog: (u32, u32),
}

impl Dbgmcu {
    /// STM32F405, with DBG_IWDG_STOP.
    pub fn f405() -> Self {
        Self { registers: Registers::new(&F405), watchdog: (0x08, 12) }
    }

    /// STM32G474, with DBG_IWDG_STOP.
    pub fn g474() -> Self {
        Self { registers: Registers::new(&G474), watchdog: (0x08, 12) }
    }

    /// STM32G431, with DBG_IWDG_STOP.
    pub fn g431() -> Self {
        Self { registers: Registers::new(&G431), watchdog: (0x08, 12) }
    }

    /// STM32H743, with DBG_IWDG1.
    pub fn h743() -> Self {
        Self { registers: Registers::new(&H743), watchdog: (0x54, 18) }
    }
}

impl Peripheral for Dbgmcu {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, _offset: u32, _value: u32, _before: u32, wires: &mut Wires) {
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let (register, bit) = self.watchdog;
        wires.watchdog_stops_with_core = self.registers.is_set(register, bit);
    }

    fn reset(&mut self) {}

    fn power_lost(&mut self) {
        self.registers.reset();
    }
}

#[cfg(test)]
mod tests {
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::BASE;
    use crate::wires::{Cable, Reset, SECOND, Surroundings};

    /// If it is configured to.
    #[test]
    fn watchdog_stops_with_halted_core() {
        let machine = |chip| Machine::new(chip, Surroundings::default(), Cable::default(), 1000);
        for (mut machine, watchdog, freeze) in [
            (machine(chips::f405::chip(BASE + 0x1000)), 0x4000_3000, (0xe004_2008, 1 << 12)),
            (machine(chips::g474::chip(BASE + 0x1000)), 0x4000_3000, (0xe004_2008, 1 << 12)),
            (machine(chips::h743::chip(BASE + 0x1000)), 0x5800_4800, (0x5c00_1054, 1 << 18)),
        ] {
            machine.settle();
            // Longest time without a reload: 4096 counts by 4, half a second.
            machine.write(watchdog, 4, 0xcccc);
            machine.write(freeze.0, 4, freeze.1);
            (0..20).for_each(|_| machine.pass_without_core(SECOND / 10));
            assert_eq!(machine.wires.reset, None, "{}", machine.chip.name);
            machine.reset(Reset::Software);
            machine.write(watchdog, 4, 0xcccc);
            (0..20).for_each(|_| machine.pass_without_core(SECOND / 10));
            assert_eq!(machine.wires.reset.take(), None, "{}: a reset has taken it back", machine.chip.name);
            machine.write(freeze.0, 4, 0);
            (0..20).for_each(|_| machine.pass_without_core(SECOND / 10));
            assert_eq!(machine.wires.reset, Some(Reset::Watchdog), "{}", machine.chip.name);
            assert_eq!(machine.wires.violations.all(), []);
        }
    }
}

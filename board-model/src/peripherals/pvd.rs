//! Low-supply detector in power control of all three chips: RM0090 5.2.3, RM0440 6.2.3, RM0433 6.5.3. Its interrupt by
//! a line of EXTI is not modelled.

use crate::register::Registers;
use crate::wires::Wires;

/// Detector of a chip: registers and bits of enable, level and output, and the levels [mV].
#[derive(Debug)]
pub struct Detector {
    /// Register and bit of PVDE.
    pub enable: (u32, u32),
    /// Register and lowest bit of PLS.
    pub level: (u32, u32),
    /// Register and bit of PVDO.
    pub output: (u32, u32),
    /// Typical falling thresholds by the data sheet; 0 for the comparison with an input that nothing drives.
    pub levels: [u32; 8],
}

impl Detector {
    /// Sets the output if the supply is below the level.
    pub fn watch(&self, registers: &mut Registers, wires: &Wires) {
        let level = self.levels[registers.field(self.level.0, self.level.1, 3) as usize];
        let is_low = registers.is_set(self.enable.0, self.enable.1) && wires.supply < level;
        registers.change(self.output.0, u32::from(is_low) << self.output.1, 1 << self.output.1);
    }
}

#[cfg(test)]
mod tests {
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::BASE;
    use crate::wires::{Cable, Surroundings};

    #[test]
    fn low_supply_reported_while_detector_on() {
        let machine = |chip| Machine::new(chip, Surroundings::default(), Cable::default(), 1000);
        for (mut machine, gate, enable, output) in [
            (
                machine(chips::f405::chip(BASE + 0x1000)),
                (0x4002_3840, 1 << 28),
                (0x4000_7000, 0x40d0),
                (0x4000_7004, 2),
            ),
            (
                machine(chips::g474::chip(BASE + 0x1000)),
                (0x4002_1058, 0x1000_0400),
                (0x4000_7004, 0xd),
                (0x4000_7014, 11),
            ),
            (
                machine(chips::h743::chip(BASE + 0x1000)),
                (0x5802_44f4, 0x1_0000),
                (0x5802_4800, 0xf000_c0d0),
                (0x5802_4804, 4),
            ),
        ] {
            machine.settle();
            machine.set_up(gate.0, gate.1);
            let says = |machine: &mut Machine| machine.read(output.0, 4) >> output.1 & 1;
            machine.wires.supply = 2000;
            assert_eq!(says(&mut machine), 0);
            machine.write(enable.0, 4, enable.1);
            assert_eq!(says(&mut machine), 1);
            machine.wires.supply = 3300;
            assert_eq!(says(&mut machine), 0);
            assert_eq!(machine.wires.violations.all(), []);
        }
    }
}

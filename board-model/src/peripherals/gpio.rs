//! General-purpose ports: RM0090 section 8, RM0440 section 9, RM0433 section 11. They differ in reset values, and the
//! F405 has no register BRR.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::{Mode, Pin, Wires};

const MODER: u32 = 0x00;
const OTYPER: u32 = 0x04;
const OSPEEDR: u32 = 0x08;
const PUPDR: u32 = 0x0c;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;
const BRR: u32 = 0x28;

/// Register map, with a port's reset values of MODER, OSPEEDR and PUPDR.
const fn map(moder: u32, ospeedr: u32, pupdr: u32) -> [Register; 11] {
    [
        Register::new("MODER", MODER, moder, u32::MAX).any_width(),
        Register::new("OTYPER", OTYPER, 0, 0xffff).any_width(),
        Register::new("OSPEEDR", OSPEEDR, ospeedr, u32::MAX).any_width(),
        Register::new("PUPDR", PUPDR, pupdr, u32::MAX).any_width(),
        Register::new("IDR", IDR, 0, 0xffff).special(0xffff).any_width(),
        Register::new("ODR", ODR, 0, 0xffff).any_width(),
        Register::new("BSRR", BSRR, 0, u32::MAX).special(u32::MAX).any_width(),
        Register::new("LCKR", 0x1c, 0, 0x1_ffff),
        Register::new("AFRL", AFRL, 0, u32::MAX).any_width(),
        Register::new("AFRH", AFRH, 0, u32::MAX).any_width(),
        Register::new("BRR", BRR, 0, 0xffff).special(0xffff).any_width(),
    ]
}

/// RM0090 8.4: port A has the debug pins, port B some of them; all others are inputs.
static F4_A: [Register; 11] = map(0xa800_0000, 0x0c00_0000, 0x6400_0000);
static F4_B: [Register; 11] = map(0x0000_0280, 0x0000_00c0, 0x0000_0100);
static F4_OTHER: [Register; 11] = map(0, 0, 0);
/// RM0440 9.4, RM0433 11.4: after a reset all pins but the debug pins are analog.
static NEWER_A: [Register; 11] = map(0xabff_ffff, 0x0c00_0000, 0x6400_0000);
static NEWER_B: [Register; 11] = map(0xffff_febf, 0x0000_00c0, 0x0000_0100);
static NEWER_OTHER: [Register; 11] = map(0xffff_ffff, 0, 0);

/// General-purpose port.
#[derive(Debug)]
pub struct Gpio {
    port: char,
    has_brr: bool,
    registers: Registers,
    /// True if the pins on the wires are not up to date.
    is_new: bool,
}

impl Gpio {
    /// Port of the STM32F405.
    pub fn f4(port: char) -> Self {
        let table = match port {
            'A' => &F4_A,
            'B' => &F4_B,
            _ => &F4_OTHER,
        };
        // RM0090 8.4.11: its register map ends with AFRH.
        Self { port, has_brr: false, registers: Registers::new(&table[..10]), is_new: true }
    }

    /// Port of the STM32G474, and of the STM32H743, which has no BRR either (RM0433 11.4).
    pub fn newer(port: char, has_brr: bool) -> Self {
        let table = match port {
            'A' => &NEWER_A,
            'B' => &NEWER_B,
            _ => &NEWER_OTHER,
        };
        Self { port, has_brr, registers: Registers::new(&table[..if has_brr { 11 } else { 10 }]), is_new: true }
    }

    /// Returns whether any setting of a pin differs from its reset value.
    fn is_set_up(&self, pin: u32) -> bool {
        let functions = if pin < 8 { AFRL } else { AFRH };
        [(MODER, 2), (OTYPER, 1), (OSPEEDR, 2), (PUPDR, 2), (ODR, 1), (functions, 4)].into_iter().any(
            |(offset, width)| {
                let reset = self.registers.describe(offset).map_or(0, |register| register.reset);
                let place = width * if width == 4 { pin % 8 } else { pin };
                (self.registers.get(offset) ^ reset) >> place & ((1 << width) - 1) != 0
            },
        )
    }

    fn mode(&self, pin: u32) -> Mode {
        match self.registers.field(MODER, 2 * pin, 2) {
            0 => Mode::Input,
            1 => Mode::Output(self.registers.is_set(ODR, pin)),
            2 => Mode::Alternate(self.registers.field(if pin < 8 { AFRL } else { AFRH }, 4 * (pin % 8), 4)),
            _ => Mode::Analog,
        }
    }
}

impl Peripheral for Gpio {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        match offset {
            IDR => (0..16).map(|pin| u32::from(wires.level(Pin(self.port, pin))) << pin).sum(),
            // RM0090 8.4.7: write-only, reads as 0.
            BSRR | BRR => 0,
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, _before: u32, wires: &mut Wires) {
        match offset {
            // Setting has priority over resetting.
            BSRR => self.registers.change(ODR, value & 0xffff, value >> 16 & !value),
            BRR if self.has_brr => self.registers.change(ODR, 0, value & 0xffff),
            _ => {}
        }
        // RM0090 8.3.1: PA13 and PA14 are the debug port.
        if self.port == 'A' && offset == MODER && self.registers.field(MODER, 26, 4) != 0b1010 {
            wires.violation("GPIOA_MODER", "takes the debug port's pins PA13 and PA14", "RM0090 8.3.1");
        }
        self.is_new = true;
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        if !std::mem::take(&mut self.is_new) {
            return;
        }
        for pin in 0..16 {
            wires.pins.insert(Pin(self.port, pin), self.mode(pin));
            if self.is_set_up(pin) {
                wires.set_up.insert(Pin(self.port, pin));
            }
        }
        wires.look_at_select();
    }

    fn reset(&mut self) {
        self.registers.reset();
        self.is_new = true;
    }
}

#[cfg(test)]
mod tests {
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::BASE;
    use crate::wires::{Cable, Pin, Reset, Surroundings};

    #[test]
    fn pin_setup_recorded() {
        let mut machine =
            Machine::new(chips::f405::chip(BASE + 0x1000), Surroundings::default(), Cable::default(), 1000);
        machine.settle();
        machine.set_up(0x4002_3830, 0b111);
        // A mode and back to its reset value, a pull, a function, and the debug port unchanged.
        for (address, value) in [
            (0x4002_0800, 1 << 6),
            (0x4002_0800, 0),
            (0x4002_080c, 1 << 10),
            (0x4002_0424, 7 << 8),
            (0x4002_0000, 0xa800_0000),
        ] {
            machine.write(address, 4, value);
        }
        let set_up = [Pin('B', 10), Pin('C', 3), Pin('C', 5)].into();
        assert_eq!(machine.wires.set_up, set_up);
        machine.reset(Reset::Software);
        machine.settle();
        assert_eq!(machine.wires.set_up, set_up);
        assert_eq!(machine.wires.violations.all(), []);
    }
}

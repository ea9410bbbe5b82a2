//! General-purpose ports: RM0090 section 8, RM0440 section 9, RM0433 section 11. The three differ in reset values, and F405
//! has no register BRR.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::{Mode, Pin, Wires};

const MODER: u32 = 0x00;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;
const BRR: u32 = 0x28;

/// The register map, with a port's reset values of MODER, OSPEEDR and PUPDR.
const fn map(moder: u32, ospeedr: u32, pupdr: u32) -> [Register; 11] {
    [
        Register::new("MODER", MODER, moder, u32::MAX).any_width(),
        Register::new("OTYPER", 0x04, 0, 0xffff).any_width(),
        Register::new("OSPEEDR", 0x08, ospeedr, u32::MAX).any_width(),
        Register::new("PUPDR", 0x0c, pupdr, u32::MAX).any_width(),
        Register::new("IDR", IDR, 0, 0xffff).special(0xffff).any_width(),
        Register::new("ODR", ODR, 0, 0xffff).any_width(),
        Register::new("BSRR", BSRR, 0, u32::MAX).special(u32::MAX).any_width(),
        Register::new("LCKR", 0x1c, 0, 0x1_ffff),
        Register::new("AFRL", AFRL, 0, u32::MAX).any_width(),
        Register::new("AFRH", AFRH, 0, u32::MAX).any_width(),
        Register::new("BRR", BRR, 0, 0xffff).special(0xffff).any_width(),
    ]
}

/// RM0090 8.4: port A holds the debug pins, port B some of them; all others are inputs.
static F4_A: [Register; 11] = map(0xa800_0000, 0x0c00_0000, 0x6400_0000);
static F4_B: [Register; 11] = map(0x0000_0280, 0x0000_00c0, 0x0000_0100);
static F4_OTHER: [Register; 11] = map(0, 0, 0);
/// RM0440 9.4, RM0433 11.4: pins are analog after a reset, but for the debug pins.
static NEWER_A: [Register; 11] = map(0xabff_ffff, 0x0c00_0000, 0x6400_0000);
static NEWER_B: [Register; 11] = map(0xffff_febf, 0x0000_00c0, 0x0000_0100);
static NEWER_OTHER: [Register; 11] = map(0xffff_ffff, 0, 0);

/// A port.
#[derive(Debug)]
pub struct Gpio {
    port: char,
    has_brr: bool,
    registers: Registers,
    /// Its pins are not yet on the wires as they are.
    is_new: bool,
}

impl Gpio {
    /// Of F405.
    pub fn f4(port: char) -> Self {
        let table = match port {
            'A' => &F4_A,
            'B' => &F4_B,
            _ => &F4_OTHER,
        };
        // RM0090 8.4.11: its map ends with AFRH.
        Self { port, has_brr: false, registers: Registers::new(&table[..10]), is_new: true }
    }

    /// Of G474, and of H743, which has no BRR either (RM0433 11.4).
    pub fn newer(port: char, has_brr: bool) -> Self {
        let table = match port {
            'A' => &NEWER_A,
            'B' => &NEWER_B,
            _ => &NEWER_OTHER,
        };
        Self { port, has_brr, registers: Registers::new(&table[..if has_brr { 11 } else { 10 }]), is_new: true }
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
        }
    }

    fn reset(&mut self) {
        self.registers.reset();
        self.is_new = true;
    }
}

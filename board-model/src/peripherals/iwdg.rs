//! Independent watchdog: RM0090 section 21, RM0440 section 42, RM0433 section 45. Only the newer ones have a window. It
//! can be frozen while a debugger holds the core.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::{Reset, Time, Wires, cycles};

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0c;
const WINR: u32 = 0x10;

static MAP: [Register; 5] = [
    Register::new("IWDG_KR", KR, 0, 0xffff).special(0xffff).half_words(),
    Register::new("IWDG_PR", PR, 0, 0x7).special(0x7).half_words(),
    Register::new("IWDG_RLR", RLR, 0xfff, 0xfff).special(0xfff).half_words(),
    Register::new("IWDG_SR", SR, 0, 0x7).special(0x7).half_words(),
    Register::new("IWDG_WINR", WINR, 0xfff, 0xfff).special(0xfff).half_words(),
];

/// Frequency of its oscillator, 17 to 47 kHz on the F405, nominally 32 kHz on all [Hz].
const OSCILLATOR: u64 = 32_000;
/// Cycles of the oscillator before a new setting takes effect (RM0090 21.4.4).
const TAKE_UP: u64 = 5;

/// Independent watchdog.
#[derive(Debug)]
pub struct Iwdg {
    registers: Registers,
    runs: bool,
    unlocked: bool,
    expires: Option<Time>,
    /// Times at which new settings take effect: prescaler, reload value.
    updates: [Option<Time>; 2],
    /// Time of the last update.
    seen: Time,
}

impl Iwdg {
    /// Watchdog of a chip with or without a window.
    pub fn new(has_window: bool) -> Self {
        let registers = Registers::new(if has_window { &MAP } else { &MAP[..4] });
        Self { registers, runs: false, unlocked: false, expires: None, updates: [None; 2], seen: 0 }
    }

    fn feed(&mut self, wires: &Wires) {
        if self.runs {
            // RM0090 21.4.2: divider 4, 8, ... 256; both 6 and 7 are 256.
            let divider = 4 << self.registers.get(PR).min(6);
            let counts = u64::from(self.registers.get(RLR)) + 1;
            self.expires = Some(wires.now + cycles(counts * divider, OSCILLATOR));
        }
    }

    fn set(&mut self, which: usize, offset: u32, value: u32, wires: &mut Wires) {
        let name = MAP[offset as usize / 4].name;
        if !self.unlocked {
            wires.violation(name, "is written while protected: 0x5555 into IWDG_KR first", "RM0090 21.3.2");
        } else if self.updates[which].is_some() {
            wires.violation(name, "is written while the value before is taken up", "RM0090 21.4.4");
        } else {
            self.registers.set(offset, value);
            self.updates[which] = Some(wires.now + cycles(TAKE_UP, OSCILLATOR));
        }
    }
}

impl Peripheral for Iwdg {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        match offset {
            KR => 0,
            SR => self.updates.iter().zip(0..).map(|(update, bit)| u32::from(update.is_some()) << bit).sum(),
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, _before: u32, wires: &mut Wires) {
        self.advance(wires);
        match offset {
            KR => {
                // RM0090 21.3.2: any other value restores the write protection.
                self.unlocked = value == 0x5555;
                match value {
                    0x5555 => {}
                    0xaaaa => self.feed(wires),
                    0xcccc => {
                        self.runs = true;
                        self.feed(wires);
                    }
                    _ => wires.violation("IWDG_KR", format!("takes no key {value:#06x}"), "RM0090 21.4.1"),
                }
            }
            PR => self.set(0, PR, value, wires),
            RLR => self.set(1, RLR, value, wires),
            SR => wires.violation("IWDG_SR", "is read-only", "RM0090 21.4.4"),
            _ => wires.violation("IWDG_WINR", "windows are not modelled", "RM0440 42.3.2"),
        }
    }

    fn advance(&mut self, wires: &mut Wires) {
        let passed = wires.now - std::mem::replace(&mut self.seen, wires.now);
        if wires.is_held && wires.watchdog_stops_with_core {
            self.expires = self.expires.map(|expires| expires + passed);
        }
        for update in &mut self.updates {
            if update.is_some_and(|ready| ready <= wires.now) {
                *update = None;
            }
        }
        if self.expires.is_some_and(|expires| expires <= wires.now) {
            wires.reset = Some(Reset::Watchdog);
        }
    }

    fn next_event(&self) -> Option<Time> {
        self.expires
    }

    /// Keeps the watchdog running: only a reset of the chip stops it.
    fn reset(&mut self) {
        *self = Self::new(self.registers.describe(WINR).is_some());
    }
}

//! What is known of a chip, in one shape for all of them.

use model_core::gears::design::Processor;

use crate::pin::{Alternate, Pin};
use crate::pll::PllLimits;

/// A chip: what all of its packages have in common.
#[derive(Debug)]
pub(crate) struct Facts {
    /// Its name: the firmware's feature.
    pub name: &'static str,
    /// Chips with the same registers: what the firmware is compiled for.
    pub family: &'static str,
    /// Core clock [Hz].
    pub core_rate: u32,
    /// What it gives the step.
    pub processor: Processor,
    /// Its internal oscillator [Hz].
    pub internal_oscillator: u32,
    /// Least and greatest frequency of a crystal [Hz].
    pub crystal: (u32, u32),
    /// Least and greatest frequency of a clock from elsewhere [Hz].
    pub signal: (u32, u32),
    /// Where crystal or clock are connected.
    pub oscillator_pins: [Pin; 2],
    /// Its PLL.
    pub pll: PllLimits,
    /// The pin that is read as BOOT0 at a reset and is free afterwards, if there is one.
    pub boot_pin: Option<Pin>,
    /// Units that can be the line to the host.
    pub serial: &'static [SerialUnit],
    /// Units that look as if they could and cannot, each with the reason.
    pub refused: &'static [(&'static str, &'static str)],
    /// Units that can be a slave of a motor controller, or why there are none.
    pub spi: Result<&'static [SpiUnit], &'static str>,
    /// Units that are on CAN.
    pub can: &'static [CanUnit],
    /// Timers that count the pulses of an encoder.
    pub timers: &'static [TimerUnit],
    /// RAM from 0x2000_0000 on without a gap, that of other purposes left out [KiB].
    pub ram_kib: u32,
    /// Two places at the end of the flash that are erased without touching an image, by the flash that the board uses
    /// [bytes].
    pub slots: fn(u32) -> [Slot; 2],
    /// Images of joint Q1 as they were linked; one that was never linked is left out. `joint hil --check` holds them against
    /// the images that it builds.
    pub images: &'static [ImageSize],
    /// By what it is ordered.
    pub variants: &'static [Variant],
}

/// A part of the flash that is erased by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slot {
    /// Its first byte.
    pub address: u32,
    /// What may be used of it: no more than is erased at once.
    pub bytes: u32,
}

/// Memory that an image takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageSize {
    /// Role, as `--role` names it.
    pub role: &'static str,
    /// Flash: code, constants and initial values [byte].
    pub flash: u32,
    /// RAM of its statics [byte].
    pub ram: u32,
}

/// A unit that sends and receives bytes.
#[derive(Debug)]
pub(crate) struct SerialUnit {
    pub name: &'static str,
    /// What its baud rate is divided from while the PLL runs [Hz].
    pub clock: u32,
    pub send: &'static [Alternate],
    pub receive: &'static [Alternate],
}

/// A unit that can be a slave on SPI.
#[derive(Debug)]
pub(crate) struct SpiUnit {
    pub name: &'static str,
    pub select: &'static [Alternate],
    pub clock: &'static [Alternate],
    /// To the master.
    pub out: &'static [Alternate],
    /// From the master.
    pub input: &'static [Alternate],
}

/// A unit on CAN. What connects it to its pins is nobody's business until an image uses it.
#[derive(Debug)]
pub(crate) struct CanUnit {
    pub name: &'static str,
    pub send: &'static [Pin],
    pub receive: &'static [Pin],
}

/// A timer that counts pulses of an encoder at its first two channels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimerUnit {
    pub name: &'static str,
    pub a: &'static [Pin],
    pub b: &'static [Pin],
}

/// Packages under one order name.
#[derive(Debug)]
pub(crate) struct Variant {
    /// Up to the letter of the flash: STM32F405RG.
    pub name: &'static str,
    /// Its flash, and less of it that a board may make do with; the largest last [KiB].
    pub flash_kib: &'static [u32],
    /// The one that is meant if the order name goes no further comes first.
    pub packages: &'static [Package],
}

/// What a package brings out.
#[derive(Debug)]
pub(crate) struct Package {
    /// The next letter of the order name.
    pub letter: char,
    /// Ports, each with a bit for every pin. Pins that only reset the chip are left out.
    pub pins: &'static [(char, u16)],
}

/// All pins of a port.
pub(super) const ALL: u16 = 0xffff;

impl Package {
    /// Whether it has a pin.
    pub fn has(&self, pin: Pin) -> bool {
        self.pins.iter().any(|(letter, pins)| *letter == pin.letter() && pins >> pin.number & 1 == 1)
    }
}

/// A pin by its name; one that is none does not compile.
pub(super) const fn pin(name: &str) -> Pin {
    match Pin::named(name.as_bytes()) {
        Some(pin) => pin,
        None => panic!("no pin"),
    }
}

/// A pin by its name, in a function.
pub(super) const fn at(name: &str, function: u8) -> Alternate {
    Alternate { pin: pin(name), function }
}

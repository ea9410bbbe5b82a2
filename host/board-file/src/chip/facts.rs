//! Data of a chip, in one form for all chips.

use model_core::gears::design::Processor;

use crate::bit_timing::TimingLimits;
use crate::pin::{Alternate, Pin};
use crate::pll::PllLimits;

/// Chip: data common to all of its packages.
#[derive(Debug)]
pub(crate) struct Facts {
    /// Name, equal to the firmware's feature.
    pub name: &'static str,
    /// Family of chips with the same registers, for which the firmware is compiled.
    pub family: &'static str,
    /// Core clock [Hz].
    pub core_rate: u32,
    /// Clock, cycles per instruction and share of the period offered to the step.
    pub processor: Processor,
    /// Frequency of the internal oscillator [Hz].
    pub internal_oscillator: u32,
    /// Lowest and highest frequency of a crystal [Hz].
    pub crystal: (u32, u32),
    /// Lowest and highest frequency of an external clock signal [Hz].
    pub signal: (u32, u32),
    /// Pins of crystal or clock signal.
    pub oscillator_pins: [Pin; 2],
    /// Limits of the PLL.
    pub pll: PllLimits,
    /// Pin that is read as BOOT0 at a reset and is free afterwards, if there is one.
    pub boot_pin: Option<Pin>,
    /// Peripherals supported as the serial line to the host.
    pub serial: &'static [SerialUnit],
    /// Serial peripherals that are not supported, each with the reason.
    pub unsupported_serial: &'static [(&'static str, &'static str)],
    /// Peripherals supported as SPI slave, or the reason why there are none.
    pub spi: Result<&'static [SpiUnit], &'static str>,
    /// CAN peripherals.
    pub can: &'static [CanUnit],
    /// Timers that count the pulses of an encoder.
    pub timers: &'static [TimerUnit],
    /// Contiguous RAM for data from 0x2000_0000 on [KiB].
    pub ram_kib: u32,
    /// Two slots at the end of the flash that can be erased without touching an image, from the flash that the board
    /// uses [byte].
    pub slots: fn(u32) -> [Slot; 2],
    /// Sizes of linked images of joint Q1; roles that were never linked are left out. `joint hil --check` compares them
    /// with the images that it builds.
    pub images: &'static [ImageSize],
    /// Order names.
    pub variants: &'static [Variant],
}

/// Part of the flash that is erased separately.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slot {
    /// Address of the first byte.
    pub address: u32,
    /// Usable size, at most the part erased at once.
    pub bytes: u32,
}

/// Memory that an image takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageSize {
    /// Role, as named by `--role`.
    pub role: &'static str,
    /// Flash: code, constants and initial values [byte].
    pub flash: u32,
    /// RAM of its statics [byte].
    pub ram: u32,
}

/// Serial peripheral.
#[derive(Debug)]
pub(crate) struct SerialUnit {
    pub name: &'static str,
    /// Clock from which the baud rate is divided while the PLL runs [Hz].
    pub clock: u32,
    pub send: &'static [Alternate],
    pub receive: &'static [Alternate],
}

/// Peripheral that can be an SPI slave.
#[derive(Debug)]
pub(crate) struct SpiUnit {
    pub name: &'static str,
    pub select: &'static [Alternate],
    pub clock: &'static [Alternate],
    /// Data to the master.
    pub out: &'static [Alternate],
    /// Data from the master.
    pub input: &'static [Alternate],
}

/// CAN peripheral.
#[derive(Debug)]
pub(crate) struct CanUnit {
    pub name: &'static str,
    /// Clock of the bit timing while the PLL runs [Hz].
    pub clock: u32,
    /// Ranges of the bit timing.
    pub timing: TimingLimits,
    /// Ranges of the timing of the second bit rate; `None` for classical CAN.
    pub data_timing: Option<TimingLimits>,
    pub send: &'static [Alternate],
    pub receive: &'static [Alternate],
}

impl CanUnit {
    /// FDCAN: RM0440 44.4.7 and 44.4.3, RM0433 56.5.7 and 56.5.3. DBTP.DBRP can divide by up to 32, but by 1 or 2 only
    /// while the transmitter delay is compensated (DBTP.TDC), as the driver has it.
    pub const fn flexible(
        name: &'static str,
        clock: u32,
        send: &'static [Alternate],
        receive: &'static [Alternate],
    ) -> Self {
        let timing = TimingLimits { prescaler: 512, before: 256, after: 128, jump: 128 };
        let data = TimingLimits { prescaler: 2, before: 32, after: 16, jump: 16 };
        Self { name, clock, timing, data_timing: Some(data), send, receive }
    }

    /// bxCAN: RM0090 32.9.2.
    pub const fn classic(
        name: &'static str,
        clock: u32,
        send: &'static [Alternate],
        receive: &'static [Alternate],
    ) -> Self {
        let timing = TimingLimits { prescaler: 1024, before: 16, after: 8, jump: 4 };
        Self { name, clock, timing, data_timing: None, send, receive }
    }
}

/// Timer that counts encoder pulses on its first two channels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimerUnit {
    pub name: &'static str,
    pub a: &'static [Pin],
    pub b: &'static [Pin],
}

/// Packages under one order name.
#[derive(Debug)]
pub(crate) struct Variant {
    /// Order name up to the letter of the flash size, such as STM32F405RG.
    pub name: &'static str,
    /// Sizes of flash that a board file may state; the chip's own size is the last [KiB].
    pub flash_kib: &'static [u32],
    /// Packages; the first applies if the order name names none.
    pub packages: &'static [Package],
}

/// Pins of a package.
#[derive(Debug)]
pub(crate) struct Package {
    /// Package letter of the order name.
    pub letter: char,
    /// Ports, each with a bit for every pin. Pins that serve only as reset are left out.
    pub pins: &'static [(char, u16)],
}

/// All pins of a port.
pub(super) const ALL: u16 = 0xffff;

impl Package {
    /// Returns whether the package has a pin.
    pub fn has(&self, pin: Pin) -> bool {
        self.pins.iter().any(|(letter, pins)| *letter == pin.letter() && pins >> pin.number & 1 == 1)
    }
}

/// Pin by its name; a wrong name does not compile.
pub(super) const fn pin(name: &str) -> Pin {
    match Pin::named(name.as_bytes()) {
        Some(pin) => pin,
        None => panic!("no pin"),
    }
}

/// Pin by its name, in an alternate function.
pub(super) const fn at(name: &str, function: u8) -> Alternate {
    Alternate { pin: pin(name), function }
}

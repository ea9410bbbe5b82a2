//! Checked description of a board.

use joint_file::{Problem, Source};
use model_core::gears::design::Processor;

use crate::bit_timing::BitTiming;
use crate::chip::{Chip, Slot};
use crate::pin::{Alternate, Pin};
use crate::pll::Plls;

/// Minimum of the RAM reserved for the stack [byte].
const MIN_STACK_BYTES: u32 = 8 << 10;
/// Start address of flash.
pub const FLASH_START: u32 = 0x0800_0000;
/// Start address of RAM.
pub const RAM_START: u32 = 0x2000_0000;

/// Board that images can be built for.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// Name that the board states in its hello.
    pub name: heapless::String<16>,
    /// Description for people; may be empty.
    pub description: String,
    /// Chip on the board.
    pub chip: Chip,
    /// Order name of the chip, as in the file.
    pub chip_name: String,
    /// Name of the chip in debug probes.
    pub probe_name: String,
    /// Flash, including the two slots [byte].
    pub flash_bytes: u32,
    /// Contiguous RAM [byte].
    pub ram_bytes: u32,
    /// External source of the chip's clock.
    pub clock: ExternalClock,
    /// PLL settings that make the core clock.
    pub pll: Plls,
    /// Serial line to the host.
    pub serial: Serial,
    /// SPI line to a motor controller, the board as slave.
    pub spi_slave: Option<SpiSlave>,
    /// CAN line of the role `drive`.
    pub can: Option<Can>,
    /// Encoders at motor and output, which no image reads yet.
    pub encoders: [Option<Encoder>; 2],
    /// Output that holds the board's own supply.
    pub supply: Option<Output>,
    /// Output that switches the motor on.
    pub enable: Option<Output>,
    /// Status light.
    pub light: Option<Output>,
    /// Pins that the firmware leaves in their reset state, each with its use.
    pub never_driven: Vec<(Pin, String)>,
    /// Problems that do not prevent a build.
    pub warnings: Vec<Problem>,
    /// Origin of each value, from the comment behind it.
    pub sources: Vec<Source>,
}

/// External source of the chip's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExternalClock {
    /// None: the chip's own oscillator is used.
    None,
    /// A crystal [Hz].
    Crystal(u32),
    /// External clock signal [Hz].
    Signal(u32),
}

impl ExternalClock {
    /// Frequency of the external source [Hz], if there is one.
    pub fn frequency(self) -> Option<u32> {
        match self {
            Self::None => None,
            Self::Crystal(frequency) | Self::Signal(frequency) => Some(frequency),
        }
    }
}

/// Serial line to the host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Serial {
    /// Peripheral, such as USART1.
    pub unit: &'static str,
    /// Clock from which the baud rate is divided while the PLL runs [Hz].
    pub clock: u32,
    /// Transmit pin.
    pub send: Alternate,
    /// Receive pin.
    pub receive: Alternate,
    /// Speed of the line [baud].
    pub baud: u32,
}

/// SPI line to a motor controller, the board as slave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpiSlave {
    /// Peripheral, such as SPI1.
    pub unit: &'static str,
    /// Select input, low while the master addresses this board.
    pub select: Alternate,
    /// Clock of the master.
    pub clock: Alternate,
    /// Data to the master.
    pub out: Alternate,
    /// Data from the master.
    pub input: Alternate,
}

/// CAN line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Can {
    /// Peripheral, such as CAN1 or FDCAN1.
    pub unit: &'static str,
    /// Data to the transceiver.
    pub send: Alternate,
    /// Data from the transceiver.
    pub receive: Alternate,
    /// Bit rate [bit/s].
    pub bitrate: u32,
    /// Second bit rate, for the data of CAN FD frames [bit/s].
    pub data_bitrate: Option<u32>,
    /// Timing of the bit rate.
    pub timing: BitTiming,
    /// Timing of the second bit rate.
    pub data_timing: Option<BitTiming>,
    /// Transceiver between the pins and the bus.
    pub transceiver: Transceiver,
}

/// Transceiver of a CAN line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transceiver {
    /// The board has one.
    OnBoard,
    /// The board has none.
    None,
    /// The file does not say.
    Unknown,
}

impl Can {
    /// Returns whether the peripheral has frames of CAN FD.
    pub fn is_flexible(&self) -> bool {
        self.unit.starts_with("FD")
    }

    /// Sentence about a transceiver that has to be added; `None` if the board has one.
    pub fn missing_transceiver(&self) -> Option<String> {
        let (send, receive) = (self.send.pin, self.receive.pin);
        let fast = if self.data_bitrate.is_some() { " for CAN FD" } else { "" };
        let add = format!("connect one{fast} with 3.3 V levels, its TXD to {send} and its RXD to {receive}");
        match self.transceiver {
            Transceiver::OnBoard => None,
            Transceiver::None => Some(format!("the board has no CAN transceiver: {add}")),
            Transceiver::Unknown => Some(format!(
                "the board's file does not say that there is a CAN transceiver: if there is none, {add}; if there is one, \
                 write `transceiver = \"yes\"`"
            )),
        }
    }
}

/// An encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoder {
    /// Peripheral that reads the encoder, such as SPI2 or TIM4.
    pub unit: &'static str,
    /// Pins of the encoder.
    pub pins: EncoderPins,
}

/// Pins of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderPins {
    /// SPI encoder; the board is the master.
    Spi {
        /// Select output, low while the board addresses the encoder.
        select: Pin,
        /// Clock.
        clock: Pin,
        /// Data from the encoder.
        out: Pin,
        /// Data to the encoder.
        input: Pin,
    },
    /// Pulse encoder.
    Pulses {
        /// Channel A.
        a: Pin,
        /// Channel B, a quarter of a period from channel A.
        b: Pin,
        /// Index, once per turn.
        index: Option<Pin>,
    },
}

/// Pin that switches something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Output {
    /// The pin.
    pub pin: Pin,
    /// Level in the on state.
    pub on: Level,
}

/// The level of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// Ground.
    Low,
    /// Supply voltage.
    High,
}

/// Keys of the pins of both encoders.
const ENCODER_KEYS: [[&str; 7]; 2] = [
    [
        "encoder.motor.select",
        "encoder.motor.clock",
        "encoder.motor.out",
        "encoder.motor.in",
        "encoder.motor.a",
        "encoder.motor.b",
        "encoder.motor.index",
    ],
    [
        "encoder.output.select",
        "encoder.output.clock",
        "encoder.output.out",
        "encoder.output.in",
        "encoder.output.a",
        "encoder.output.b",
        "encoder.output.index",
    ],
];

/// Largest deviation of an internal oscillator at room temperature [ppm]: STM32F405, data sheet DS8626; the other chips
/// are closer.
const INTERNAL_OSCILLATOR_PPM: u32 = 10_000;

impl Board {
    /// Two parts of the flash that keep the observer's memory.
    pub fn slots(&self) -> [Slot; 2] {
        (self.chip.facts().slots)(self.flash_bytes)
    }

    /// Flash available to an image, from its start to the first slot [byte].
    pub fn image_bytes(&self) -> u32 {
        self.slots()[0].address - FLASH_START
    }

    /// RAM available to the statics of an image; the stack has the rest [byte].
    pub fn static_bytes(&self) -> u32 {
        self.ram_bytes - MIN_STACK_BYTES
    }

    /// CAN line, or the reason why there is none.
    pub fn can_line(&self) -> Result<&Can, &'static str> {
        self.can.as_ref().ok_or("its board file has no [can]")
    }

    /// Sentence about a bit rate that is less accurate than CAN allows, since the board has no crystal and no external
    /// clock; `None` if the clock is good enough, or without CAN.
    pub fn inaccurate_can_clock(&self) -> Option<String> {
        let can = self.can.as_ref().filter(|_| self.clock == ExternalClock::None)?;
        let tolerance = can.timing.tolerance_ppm();
        (tolerance < INTERNAL_OSCILLATOR_PPM).then(|| {
            format!(
                "the chip's own oscillator is up to {} % off at room temperature, and CAN at {} bit/s allows {:.1} %: calibrate \
                 the oscillator, or lower `bitrate`",
                f64::from(INTERNAL_OSCILLATOR_PPM) / 1e4,
                can.bitrate,
                f64::from(tolerance) / 1e4
            )
        })
    }

    /// Core clock [Hz].
    pub fn core_rate(&self) -> u32 {
        self.chip.core_rate()
    }

    /// Clock, cycles per instruction and share of the period that the chip offers the step.
    pub fn processor(&self) -> Processor {
        self.chip.processor()
    }

    /// Pins that the firmware uses, with their keys, in the order of the documentation.
    pub fn used_pins(&self) -> Vec<(&'static str, Pin)> {
        let Serial { send, receive, .. } = &self.serial;
        let mut pins = vec![("serial.send", send.pin), ("serial.receive", receive.pin)];
        if let Some(SpiSlave { select, clock, out, input, .. }) = &self.spi_slave {
            pins.extend([
                ("spi_slave.select", select.pin),
                ("spi_slave.clock", clock.pin),
                ("spi_slave.out", out.pin),
                ("spi_slave.in", input.pin),
            ]);
        }
        if let Some(Can { send, receive, .. }) = self.can {
            pins.extend([("can.send", send.pin), ("can.receive", receive.pin)]);
        }
        pins.extend(self.supply.map(|output| ("supply.pin", output.pin)));
        pins.extend(self.enable.map(|output| ("enable.pin", output.pin)));
        pins.extend(self.light.map(|output| ("light.pin", output.pin)));
        pins
    }

    /// Pins of lines that no image uses yet, with their keys. The firmware leaves them in their reset state.
    pub fn unused_line_pins(&self) -> Vec<(&'static str, Pin)> {
        let mut pins = Vec::new();
        for (encoder, [select, clock, out, input, a, b, index]) in self.encoders.iter().zip(ENCODER_KEYS) {
            match encoder.map(|encoder| encoder.pins) {
                Some(EncoderPins::Spi { select: chosen, clock: clocked, out: answered, input: asked }) => {
                    pins.extend([(select, chosen), (clock, clocked), (out, answered), (input, asked)]);
                }
                Some(EncoderPins::Pulses { a: one, b: other, index: turn }) => {
                    pins.extend([(a, one), (b, other)]);
                    pins.extend(turn.map(|turn| (index, turn)));
                }
                None => {}
            }
        }
        pins
    }
}

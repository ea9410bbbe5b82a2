//! A board as its file says it, checked.

use joint_file::{Problem, Source};
use model_core::gears::design::Processor;

use crate::chip::{Chip, Slot};
use crate::pin::{Alternate, Pin};
use crate::pll::Plls;

/// RAM that is left for the stack at least [byte].
const STACK: u32 = 8 << 10;
/// Where the flash begins.
pub const FLASH_START: u32 = 0x0800_0000;
/// Where the RAM begins.
pub const RAM_START: u32 = 0x2000_0000;

/// A board that images can be built for.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// What it calls itself in its hello.
    pub name: heapless::String<16>,
    /// A sentence for people; may be empty.
    pub description: String,
    /// Its chip.
    pub chip: Chip,
    /// The chip's order name, as the file has it.
    pub chip_name: String,
    /// The chip as debug probes know it.
    pub probe_name: String,
    /// Flash, that of the slots included.
    pub flash_bytes: u32,
    /// RAM without a gap.
    pub ram_bytes: u32,
    /// What drives the chip's clock.
    pub clock: ExternalClock,
    /// What makes the core clock of it.
    pub pll: Plls,
    /// The line to the host.
    pub serial: Serial,
    /// The line to a motor controller whose slave the board is.
    pub spi_slave: Option<SpiSlave>,
    /// Its line on CAN, which no image uses yet.
    pub can: Option<Can>,
    /// Encoders of motor and output, which no image reads yet.
    pub encoders: [Option<Encoder>; 2],
    /// Holds the board's own supply.
    pub supply: Option<Output>,
    /// Switches the motor on.
    pub enable: Option<Output>,
    /// The status light.
    pub light: Option<Output>,
    /// Pins that the firmware leaves as they are after a reset, each with what it is there.
    pub never_driven: Vec<(Pin, String)>,
    /// What is odd but can be used.
    pub warnings: Vec<Problem>,
    /// Where each value comes from, by the comment behind it.
    pub sources: Vec<Source>,
}

/// What a board supplies its chip's clock from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExternalClock {
    /// Nothing: the chip's own oscillator drives it.
    None,
    /// A crystal [Hz].
    Crystal(u32),
    /// A clock that comes from elsewhere [Hz].
    Signal(u32),
}

impl ExternalClock {
    /// Its frequency [Hz], if there is any.
    pub fn frequency(self) -> Option<u32> {
        match self {
            Self::None => None,
            Self::Crystal(frequency) | Self::Signal(frequency) => Some(frequency),
        }
    }
}

/// The line to the host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Serial {
    /// The unit, such as USART1.
    pub unit: &'static str,
    /// What its baud rate is divided from while the PLL runs [Hz].
    pub clock: u32,
    /// Where it sends.
    pub send: Alternate,
    /// Where it receives.
    pub receive: Alternate,
    /// Its speed [baud].
    pub baud: u32,
}

/// The line to a motor controller whose slave the board is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpiSlave {
    /// The unit, such as SPI1.
    pub unit: &'static str,
    /// Low while the master speaks to this board.
    pub select: Alternate,
    /// The master's clock.
    pub clock: Alternate,
    /// To the master.
    pub out: Alternate,
    /// From the master.
    pub input: Alternate,
}

/// A line on CAN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Can {
    /// The unit, such as CAN1.
    pub unit: &'static str,
    /// To the transceiver.
    pub send: Pin,
    /// From the transceiver.
    pub receive: Pin,
}

/// An encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoder {
    /// The unit that reads it, such as SPI2 or TIM4.
    pub unit: &'static str,
    /// Its wires.
    pub pins: EncoderPins,
}

/// The wires of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderPins {
    /// It answers on SPI, whose master the board is.
    Spi {
        /// Low while the board speaks to it.
        select: Pin,
        /// The clock.
        clock: Pin,
        /// From the encoder.
        out: Pin,
        /// To the encoder.
        input: Pin,
    },
    /// It sends pulses.
    Pulses {
        /// One channel.
        a: Pin,
        /// The other channel, a quarter of a period apart.
        b: Pin,
        /// Once a turn.
        index: Option<Pin>,
    },
}

/// A pin that switches something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Output {
    /// The pin.
    pub pin: Pin,
    /// Its level while that is on.
    pub on: Level,
}

/// The level of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// At ground.
    Low,
    /// At the supply.
    High,
}

/// Keys of both encoders' pins.
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

impl Board {
    /// The two parts of the flash that keep what the observer has learnt.
    pub fn slots(&self) -> [Slot; 2] {
        (self.chip.facts().slots)(self.flash_bytes)
    }

    /// What an image may take of the flash, from its start to the first slot.
    pub fn image_bytes(&self) -> u32 {
        self.slots()[0].address - FLASH_START
    }

    /// Returns the RAM that the statics of an image may take: the stack has the rest [byte].
    pub fn static_bytes(&self) -> u32 {
        self.ram_bytes - STACK
    }

    /// Its core clock [Hz].
    pub fn core_rate(&self) -> u32 {
        self.chip.core_rate()
    }

    /// What it gives the step.
    pub fn processor(&self) -> Processor {
        self.chip.processor()
    }

    /// Every pin that the firmware uses, with the key that says so, in the order of the documentation.
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
        pins.extend(self.supply.map(|output| ("supply.pin", output.pin)));
        pins.extend(self.enable.map(|output| ("enable.pin", output.pin)));
        pins.extend(self.light.map(|output| ("light.pin", output.pin)));
        pins
    }

    /// Every pin of a line that no image uses yet, with the key that says so: the firmware leaves them as they are after a reset.
    pub fn pins_without_use(&self) -> Vec<(&'static str, Pin)> {
        let mut pins = Vec::new();
        if let Some(Can { send, receive, .. }) = self.can {
            pins.extend([("can.send", send), ("can.receive", receive)]);
        }
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

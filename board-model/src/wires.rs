//! What runs between the parts of a chip: clocks, clock gates, interrupt lines, pins, requests for DMA, the line to the host.
//! A peripheral sees the others through these only.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::as5047p::As5047p;
use crate::violation::Violations;

/// Time in femtoseconds: a cycle of every clock is a whole number of them to nine digits.
pub type Time = u64;
/// Femtoseconds in a second.
pub const SECOND: Time = 1_000_000_000_000_000;
/// Femtoseconds in a microsecond.
pub const MICROSECOND: Time = SECOND / 1_000_000;

/// Duration of a number of cycles of a clock [fs].
pub fn cycles(count: u64, rate: u64) -> Time {
    (u128::from(count) * u128::from(SECOND) / u128::from(rate.max(1))) as Time
}

/// Frequencies of a chip's clocks [Hz].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Clocks {
    /// Before any divider.
    pub system: u64,
    /// The core's, which SysTick counts.
    pub core: u64,
    /// That of the bus of flash and memory.
    pub bus: u64,
    /// That of the first peripheral bus.
    pub low: u64,
    /// That of the second peripheral bus.
    pub high: u64,
    /// That of the timers on it.
    pub timers: u64,
}

/// A bit of a register of the reset and clock controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Gate {
    /// Offset of the register.
    pub offset: u32,
    /// The bit.
    pub bit: u32,
}

/// A pin: port and number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pin(pub char, pub u32);

/// What a pin is set up as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Input, as most are after a reset.
    Input,
    /// Output at a level.
    Output(bool),
    /// One of the alternate functions.
    Alternate(u32),
    /// Analog.
    Analog,
}

/// Who asks for DMA.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Request {
    /// A serial peripheral interface with a byte to be fetched.
    SpiReceived(u32),
    /// One with room for a byte.
    SpiToSend(u32),
    /// A USART with a byte to be fetched.
    UsartReceived(u32),
    /// One with room for a byte.
    UsartToSend(u32),
}

impl Request {
    /// Whether what asks wants bytes from memory.
    pub fn is_outwards(self) -> bool {
        matches!(self, Self::SpiToSend(_) | Self::UsartToSend(_))
    }
}

/// Why a chip resets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reset {
    /// Power came on.
    Power,
    /// The software asked for it.
    Software,
    /// The watchdog.
    Watchdog,
}

/// What flash does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// Erases a sector or page.
    Erase,
    /// Programs what its check bits hold together.
    Program,
}

/// How far an operation of flash has come when power goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HowFar {
    /// Nothing of it has been done.
    Before,
    /// Most of it is still as it was.
    Early,
    /// As much is old as new, and most is neither.
    Middle,
    /// Most of it is done.
    Late,
}

impl HowFar {
    /// How far an operation may have come: a program is short, and is cut before it or in it.
    pub fn of(operation: Operation) -> &'static [Self] {
        match operation {
            Operation::Erase => &[Self::Before, Self::Early, Self::Middle, Self::Late],
            Operation::Program => &[Self::Before, Self::Middle],
        }
    }
}

/// When power goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// In this operation of flash, by its number since power-up, from 0.
    pub operation: usize,
    /// How far it has come.
    pub how_far: HowFar,
}

/// What the host's end of the serial line is connected to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cable {
    /// The host's speed [baud].
    pub baud: u64,
    /// Number of the USART that the line is for.
    pub unit: u32,
    /// The pin that the board sends by.
    pub send: Pin,
    /// The pin that it receives by.
    pub receive: Pin,
}

/// The serial line, as the host's end drives it.
#[derive(Debug, Default)]
pub struct Line {
    /// Where it is.
    pub cable: Cable,
    /// Sent by the host and not yet on the line.
    pub to_board: VecDeque<u8>,
    /// What the host received.
    pub to_host: Vec<u8>,
    /// The byte on its way to the board has arrived then.
    pub arrives: Option<Time>,
    /// Bytes that the board lost since the one before had not been fetched.
    pub overruns: u32,
}

/// A master on SPI, and what it has under way.
#[derive(Debug, Default)]
pub struct Master {
    /// Number of the SPI that it is on.
    pub spi: u32,
    /// Bytes still to be clocked.
    pub to_slave: VecDeque<u8>,
    /// What came back.
    pub received: Vec<u8>,
    /// The next byte is complete then.
    pub next: Option<Time>,
    /// Time that a byte takes.
    pub byte: Time,
}

impl Master {
    /// The next byte on an SPI, if it is complete.
    pub fn due(&mut self, spi: u32, now: Time) -> Option<u8> {
        let next = self.next.filter(|next| *next <= now && spi == self.spi)?;
        let byte = self.to_slave.pop_front();
        self.next = (!self.to_slave.is_empty()).then_some(next + self.byte);
        byte
    }
}

/// What is outside of the chip.
#[derive(Debug, Clone, Copy, Default)]
pub struct Surroundings {
    /// A crystal at the pins of the external oscillator [Hz].
    pub crystal: Option<u64>,
    /// A clock at its input, for the bypass [Hz].
    pub external_clock: Option<u64>,
    /// The one or the other dies then.
    pub dies_at: Option<Time>,
    /// A timer that measures it counts so many thousandths too fast: the internal oscillator is that much off. All else has it
    /// exact.
    pub internal_off: i64,
}

impl Surroundings {
    /// A crystal [Hz].
    pub fn crystal(rate: u64) -> Self {
        Self { crystal: Some(rate), ..Self::default() }
    }

    /// A clock from outside [Hz].
    pub fn clock(rate: u64) -> Self {
        Self { external_clock: Some(rate), ..Self::default() }
    }

    /// Whether the external source is dead.
    pub fn is_dead(&self, now: Time) -> bool {
        self.dies_at.is_some_and(|time| time <= now)
    }
}

/// All of it.
#[derive(Debug)]
pub struct Wires {
    /// Time since power-up.
    pub now: Time,
    /// Where the core is.
    pub pc: u32,
    /// What was done wrong so far.
    pub violations: Violations,
    /// Clocks as they are.
    pub clocks: Clocks,
    /// The external oscillator as timers can capture it: divided, while it runs [Hz].
    pub divided_external: Option<u64>,
    /// Registers of the clock controller by offset, as far as they switch clocks on and hold resets.
    pub gates: BTreeMap<u32, u32>,
    /// Interrupt lines that are high.
    pub interrupts: BTreeSet<usize>,
    /// Pins that are not as after a reset.
    pub pins: BTreeMap<Pin, Mode>,
    /// Pins that were ever set up in another way than a reset does.
    pub set_up: BTreeSet<Pin>,
    /// Levels that somebody outside drives.
    pub driven: BTreeMap<Pin, bool>,
    /// The port behind each external interrupt line, by number.
    pub line_ports: [char; 16],
    /// Who asks for DMA.
    pub requests: BTreeSet<Request>,
    /// Requests that a channel which is on serves.
    pub served: BTreeSet<Request>,
    /// The master on SPI.
    pub master: Master,
    /// A slave on SPI.
    pub encoder: Option<As5047p>,
    /// Bytes of the present access to a register.
    pub width: u32,
    /// Requests that a multiplexer leads to a channel of DMA, by controller and channel.
    pub routes: BTreeMap<(u32, u32), Option<Request>>,
    /// The serial line.
    pub line: Line,
    /// What is outside.
    pub surroundings: Surroundings,
    /// The core stands still so long.
    pub stall: Time,
    /// The non-maskable interrupt is asked for.
    pub non_maskable: bool,
    /// An access failed, at this address.
    pub bus_fault: Option<u32>,
    /// The chip is to be reset.
    pub reset: Option<Reset>,
    /// A debugger holds the core.
    pub is_held: bool,
    /// The watchdog stands still while it does.
    pub watchdog_stops_with_core: bool,
    /// PB4 and PB6 are pulled down for an empty battery on USB.
    pub pulls_down_for_usb: bool,
    /// The regulator gives the highest range, with boost where there is one.
    pub boost: bool,
    /// The supply [mV].
    pub supply: u32,
    /// Scale or range of the regulator by its number in the manual: 1 is the fastest.
    pub voltage: u32,
    /// A level has changed, or something else that is looked at between blocks.
    pub changed: bool,
    /// Whoever reads a register waits for flash: time may go on faster.
    pub waiting: bool,
    /// A data synchronisation barrier was executed since the last store to flash.
    pub barrier: bool,
    /// An image lies in flash up to here.
    pub image_end: u32,
    /// Option byte DBANK of G474 is 0: its flash is one bank.
    pub single_bank: bool,
    /// When power goes.
    pub cut: Option<Cut>,
    /// Operations that flash has begun.
    pub flash_operations: Vec<Operation>,
}

impl Wires {
    /// At power-up.
    pub fn new(surroundings: Surroundings, cable: Cable) -> Self {
        Self {
            now: 0,
            pc: 0,
            violations: Violations::default(),
            clocks: Clocks::default(),
            divided_external: None,
            gates: BTreeMap::new(),
            interrupts: BTreeSet::new(),
            pins: BTreeMap::new(),
            set_up: BTreeSet::new(),
            driven: BTreeMap::new(),
            line_ports: ['A'; 16],
            requests: BTreeSet::new(),
            served: BTreeSet::new(),
            master: Master::default(),
            encoder: None,
            width: 4,
            routes: BTreeMap::new(),
            line: Line { cable, ..Line::default() },
            surroundings,
            stall: 0,
            non_maskable: false,
            bus_fault: None,
            reset: None,
            is_held: false,
            watchdog_stops_with_core: false,
            pulls_down_for_usb: false,
            boost: false,
            supply: 3300,
            voltage: 1,
            changed: false,
            waiting: false,
            barrier: true,
            image_end: 0,
            single_bank: false,
            cut: None,
            flash_operations: Vec::new(),
        }
    }

    /// Notes a violation where the core is.
    pub fn violation(&mut self, register: &str, what: impl Into<String>, section: &'static str) {
        self.violations.add(register, self.pc, what, section);
    }

    /// Whether a bit of the clock controller is set.
    pub fn is_on(&self, gate: Gate) -> bool {
        self.gates.get(&gate.offset).is_some_and(|value| value >> gate.bit & 1 == 1)
    }

    /// What a pin is set up as.
    pub fn mode(&self, pin: Pin) -> Mode {
        self.pins.get(&pin).copied().unwrap_or(Mode::Input)
    }

    /// Whether one of some pins has its alternate function.
    pub fn leads_to(&self, pins: &[(Pin, u32)]) -> bool {
        pins.iter().any(|(pin, function)| self.mode(*pin) == Mode::Alternate(*function))
    }

    /// Whether a pin is one of some pins and has its alternate function.
    pub fn leads_by(&self, pin: Pin, pins: &[(Pin, u32)]) -> bool {
        pins.iter().any(|(other, function)| *other == pin && self.mode(pin) == Mode::Alternate(*function))
    }

    /// The level at a pin: its own, or that from outside, or low.
    pub fn level(&self, pin: Pin) -> bool {
        match self.mode(pin) {
            Mode::Output(level) => level,
            _ => self.driven.get(&pin).copied().unwrap_or(false),
        }
    }

    /// A master on the chip clocks eight bits, in a mode (CPOL, CPHA); what it receives: an open line is high.
    pub fn clock_slave(&mut self, spi: u32, byte: u8, mode: (bool, bool), bit: Time, start: Time) -> u8 {
        let Some(encoder) = self.encoder.as_mut().filter(|encoder| encoder.spi == spi) else { return 0xff };
        let (answer, wrong) = encoder.exchange(byte, mode, bit, start);
        if let Some(what) = wrong {
            self.violation("AS5047P", what, "DS000324, SPI timing");
        }
        answer
    }

    /// Pins have other levels: the slave may be selected now, or no more.
    pub fn look_at_select(&mut self) {
        let Some(select) = self.encoder.as_ref().map(|encoder| encoder.select) else { return };
        let (is_low, now) = (self.mode(select) == Mode::Output(false), self.now);
        if let Some(what) = self.encoder.as_mut().and_then(|encoder| encoder.selected(is_low, now)) {
            self.violation("AS5047P", what, "DS000324, SPI timing");
        }
    }

    /// Levels an interrupt line.
    pub fn interrupt(&mut self, line: usize, level: bool) {
        self.changed |= match level {
            true => self.interrupts.insert(line),
            false => self.interrupts.remove(&line),
        };
    }

    /// A flash operation begins; how far it comes, if power goes with it.
    pub fn begins_flash_operation(&mut self, operation: Operation) -> Option<HowFar> {
        let number = self.flash_operations.len();
        self.flash_operations.push(operation);
        let cut = self.cut.take_if(|cut| cut.operation == number)?;
        self.reset = Some(Reset::Power);
        Some(cut.how_far)
    }

    /// A channel serves a request, or no more.
    pub fn serve(&mut self, request: Request, level: bool) {
        if level {
            self.served.insert(request);
        } else {
            self.served.remove(&request);
        }
    }

    /// Whether a channel that is on serves a request.
    pub fn is_served(&self, request: Request) -> bool {
        self.served.contains(&request)
    }

    /// Asks for DMA, or no more.
    pub fn request(&mut self, request: Request, level: bool) {
        self.changed |= match level {
            true => self.requests.insert(request),
            false => self.requests.remove(&request),
        };
    }
}

//! Connections between the parts of a chip: clocks, clock gates, interrupt lines, pins, DMA requests, the line to the
//! host. Peripherals interact only through these.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::as5047p::As5047p;
use crate::can_bus::{CanBus, CanCable};
use crate::violation::Violations;

/// Time in femtoseconds, in which a cycle of every clock is an integer to nine digits.
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
    /// Clock before any divider.
    pub system: u64,
    /// Clock of the core, counted by SysTick.
    pub core: u64,
    /// Clock of the bus of flash and memory.
    pub bus: u64,
    /// Clock of the first peripheral bus.
    pub low: u64,
    /// Clock of the second peripheral bus.
    pub high: u64,
    /// Clock of the timers on the second peripheral bus.
    pub timers: u64,
}

/// Clock of the bit timing of FDCAN.
#[derive(Debug, Clone, Copy, Default)]
pub struct FdcanClock {
    /// Selected clock [Hz]; 0 while it does not run.
    pub selected: u64,
    /// Divider between that clock and the peripherals; `None` if it is not settled.
    pub divider: Option<u64>,
    /// True while the settings of the divider can be changed.
    pub is_open: bool,
}

/// Bit of a register of the reset and clock controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Gate {
    /// Offset of the register.
    pub offset: u32,
    /// Number of the bit.
    pub bit: u32,
}

/// Pin as port and number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pin(pub char, pub u32);

/// Mode of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Input, the mode of most pins after a reset.
    Input,
    /// Output with its level.
    Output(bool),
    /// Alternate function with its number.
    Alternate(u32),
    /// Analog.
    Analog,
}

/// Source of a DMA request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Request {
    /// SPI with a received byte.
    SpiReceived(u32),
    /// SPI with room for a byte to send.
    SpiToSend(u32),
    /// USART with a received byte.
    UsartReceived(u32),
    /// USART with room for a byte to send.
    UsartToSend(u32),
}

impl Request {
    /// Returns whether the request is for bytes from memory.
    pub fn is_outwards(self) -> bool {
        matches!(self, Self::SpiToSend(_) | Self::UsartToSend(_))
    }
}

/// Cause of a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reset {
    /// Power-up.
    Power,
    /// Request by software.
    Software,
    /// Watchdog.
    Watchdog,
}

/// Flash operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// Erase of a sector or page.
    Erase,
    /// Program of a unit with common check bits.
    Program,
}

/// Progress of a flash operation at a power cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HowFar {
    /// Not started.
    Before,
    /// Most of it unchanged.
    Early,
    /// Equal parts old and new, and most of it damaged.
    Middle,
    /// Most of it done.
    Late,
}

impl HowFar {
    /// Possible progress of an operation: a program is short, and is cut before it or within it.
    pub fn of(operation: Operation) -> &'static [Self] {
        match operation {
            Operation::Erase => &[Self::Before, Self::Early, Self::Middle, Self::Late],
            Operation::Program => &[Self::Before, Self::Middle],
        }
    }
}

/// Power cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// Number of the interrupted flash operation since power-up, from 0.
    pub operation: usize,
    /// Progress of the operation at the cut.
    pub how_far: HowFar,
}

/// Connection of the host's end of the serial line.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cable {
    /// Speed of the host [baud].
    pub baud: u64,
    /// Number of the board's USART.
    pub unit: u32,
    /// Transmit pin of the board.
    pub send: Pin,
    /// Receive pin of the board.
    pub receive: Pin,
}

/// Serial line, as driven by the host's end.
#[derive(Debug, Default)]
pub struct Line {
    /// Connection of the line.
    pub cable: Cable,
    /// Bytes from the host that are not yet on the line.
    pub to_board: VecDeque<u8>,
    /// Bytes received by the host.
    pub to_host: Vec<u8>,
    /// Arrival time of the byte in transmission to the board.
    pub arrives: Option<Time>,
    /// Bytes lost by the board because the preceding one had not been read.
    pub overruns: u32,
}

/// External SPI master, with its transfer.
#[derive(Debug, Default)]
pub struct Master {
    /// Number of the SPI that it is connected to.
    pub spi: u32,
    /// Bytes still to be sent.
    pub to_slave: VecDeque<u8>,
    /// Bytes received.
    pub received: Vec<u8>,
    /// Time at which the next byte is complete.
    pub next: Option<Time>,
    /// Duration of a byte.
    pub byte: Time,
}

impl Master {
    /// Next byte for an SPI, if it is complete.
    pub fn due(&mut self, spi: u32, now: Time) -> Option<u8> {
        let next = self.next.filter(|next| *next <= now && spi == self.spi)?;
        let byte = self.to_slave.pop_front();
        self.next = (!self.to_slave.is_empty()).then_some(next + self.byte);
        byte
    }
}

/// Clock sources outside of the chip.
#[derive(Debug, Clone, Copy, Default)]
pub struct Surroundings {
    /// Crystal at the pins of the external oscillator [Hz].
    pub crystal: Option<u64>,
    /// Clock signal at the input, for the bypass [Hz].
    pub external_clock: Option<u64>,
    /// Time at which crystal or signal fails.
    pub dies_at: Option<Time>,
    /// Deviation of the internal oscillator [thousandths]: a timer that measures the external source counts this much
    /// too fast. All other parts use the exact frequency.
    pub internal_off: i64,
}

impl Surroundings {
    /// Surroundings with a crystal [Hz].
    pub fn crystal(rate: u64) -> Self {
        Self { crystal: Some(rate), ..Self::default() }
    }

    /// Surroundings with a clock signal [Hz].
    pub fn clock(rate: u64) -> Self {
        Self { external_clock: Some(rate), ..Self::default() }
    }

    /// Returns whether the external source has failed.
    pub fn is_dead(&self, now: Time) -> bool {
        self.dies_at.is_some_and(|time| time <= now)
    }
}

/// Connections of the whole chip.
#[derive(Debug)]
pub struct Wires {
    /// Time since power-up.
    pub now: Time,
    /// Code address of the core.
    pub pc: u32,
    /// Violations so far.
    pub violations: Violations,
    /// Present clocks.
    pub clocks: Clocks,
    /// Clock of the bit timing of FDCAN.
    pub fdcan: FdcanClock,
    /// Divided external source for capture by timers, while it runs [Hz].
    pub divided_external: Option<u64>,
    /// Registers of the clock controller by offset, with clock gates and resets.
    pub gates: BTreeMap<u32, u32>,
    /// Interrupt lines that are high.
    pub interrupts: BTreeSet<usize>,
    /// Modes of the pins.
    pub pins: BTreeMap<Pin, Mode>,
    /// Pins whose setting ever differed from the reset state.
    pub set_up: BTreeSet<Pin>,
    /// Levels driven from outside.
    pub driven: BTreeMap<Pin, bool>,
    /// Port of each external interrupt line, by number.
    pub line_ports: [char; 16],
    /// Active DMA requests.
    pub requests: BTreeSet<Request>,
    /// Requests served by an enabled channel.
    pub served: BTreeSet<Request>,
    /// CAN bus.
    pub can: CanBus,
    /// External SPI master.
    pub master: Master,
    /// External SPI slave.
    pub encoder: Option<As5047p>,
    /// Width of the present register access [byte].
    pub width: u32,
    /// Requests routed to DMA channels by a multiplexer, by controller and channel.
    pub routes: BTreeMap<(u32, u32), Option<Request>>,
    /// The serial line.
    pub line: Line,
    /// Clock sources outside of the chip.
    pub surroundings: Surroundings,
    /// Time for which the core must stall.
    pub stall: Time,
    /// True if the non-maskable interrupt is requested.
    pub non_maskable: bool,
    /// Address of a failed access.
    pub bus_fault: Option<u32>,
    /// Reset to be executed.
    pub reset: Option<Reset>,
    /// True while a debugger holds the core.
    pub is_held: bool,
    /// True if the watchdog is frozen while the core is held.
    pub watchdog_stops_with_core: bool,
    /// True if the USB dead-battery pull-downs at PB4 and PB6 are on (bit UCPD1_DBDIS is 0).
    pub pulls_down_for_usb: bool,
    /// True if the regulator is in its highest range, with boost if there is one.
    pub boost: bool,
    /// Supply voltage [mV].
    pub supply: u32,
    /// Scale or range of the regulator, by its number in the manual: 1 is the fastest.
    pub voltage: u32,
    /// True if a level, or anything else checked between blocks, has changed.
    pub changed: bool,
    /// True if the last read polls busy flash, so that time may advance faster.
    pub waiting: bool,
    /// True if a data synchronisation barrier was executed since the last store to flash.
    pub barrier: bool,
    /// End address of the image in flash.
    pub image_end: u32,
    /// True if option byte DBANK of the G474 is 0: single-bank flash.
    pub single_bank: bool,
    /// Planned power cut.
    pub cut: Option<Cut>,
    /// Flash operations started so far.
    pub flash_operations: Vec<Operation>,
}

impl Wires {
    /// State at power-up.
    pub fn new(surroundings: Surroundings, cable: Cable) -> Self {
        Self {
            now: 0,
            pc: 0,
            violations: Violations::default(),
            clocks: Clocks::default(),
            fdcan: FdcanClock::default(),
            divided_external: None,
            gates: BTreeMap::new(),
            interrupts: BTreeSet::new(),
            pins: BTreeMap::new(),
            set_up: BTreeSet::new(),
            driven: BTreeMap::new(),
            line_ports: ['A'; 16],
            requests: BTreeSet::new(),
            served: BTreeSet::new(),
            can: CanBus::new(CanCable::default()),
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

    /// Records a violation at the core's address.
    pub fn violation(&mut self, register: &str, what: impl Into<String>, section: &'static str) {
        self.violations.add(register, self.pc, what, section);
    }

    /// Returns whether a bit of the clock controller is set.
    pub fn is_on(&self, gate: Gate) -> bool {
        self.gates.get(&gate.offset).is_some_and(|value| value >> gate.bit & 1 == 1)
    }

    /// Mode of a pin.
    pub fn mode(&self, pin: Pin) -> Mode {
        self.pins.get(&pin).copied().unwrap_or(Mode::Input)
    }

    /// Returns whether one of some pins has its alternate function.
    pub fn leads_to(&self, pins: &[(Pin, u32)]) -> bool {
        pins.iter().any(|(pin, function)| self.mode(*pin) == Mode::Alternate(*function))
    }

    /// Returns whether a pin is one of some pins and has its alternate function.
    pub fn leads_by(&self, pin: Pin, pins: &[(Pin, u32)]) -> bool {
        pins.iter().any(|(other, function)| *other == pin && self.mode(pin) == Mode::Alternate(*function))
    }

    /// Level at a pin: its own output, else the level driven from outside, else low.
    pub fn level(&self, pin: Pin) -> bool {
        match self.mode(pin) {
            Mode::Output(level) => level,
            _ => self.driven.get(&pin).copied().unwrap_or(false),
        }
    }

    /// Exchanges eight bits with the external slave, in a mode (CPOL, CPHA); an open line reads as high.
    pub fn clock_slave(&mut self, spi: u32, byte: u8, mode: (bool, bool), bit: Time, start: Time) -> u8 {
        let Some(encoder) = self.encoder.as_mut().filter(|encoder| encoder.spi == spi) else { return 0xff };
        let (answer, wrong) = encoder.exchange(byte, mode, bit, start);
        if let Some(what) = wrong {
            self.violation("AS5047P", what, "DS000324, SPI timing");
        }
        answer
    }

    /// Updates the slave's select after a change of levels.
    pub fn look_at_select(&mut self) {
        let Some(select) = self.encoder.as_ref().map(|encoder| encoder.select) else { return };
        let (is_low, now) = (self.mode(select) == Mode::Output(false), self.now);
        if let Some(what) = self.encoder.as_mut().and_then(|encoder| encoder.selected(is_low, now)) {
            self.violation("AS5047P", what, "DS000324, SPI timing");
        }
    }

    /// Sets the level of an interrupt line.
    pub fn interrupt(&mut self, line: usize, level: bool) {
        self.changed |= match level {
            true => self.interrupts.insert(line),
            false => self.interrupts.remove(&line),
        };
    }

    /// Starts a flash operation; returns its progress if power is cut in it.
    pub fn begins_flash_operation(&mut self, operation: Operation) -> Option<HowFar> {
        let number = self.flash_operations.len();
        self.flash_operations.push(operation);
        let cut = self.cut.take_if(|cut| cut.operation == number)?;
        self.reset = Some(Reset::Power);
        Some(cut.how_far)
    }

    /// Sets whether a channel serves a request.
    pub fn serve(&mut self, request: Request, level: bool) {
        if level {
            self.served.insert(request);
        } else {
            self.served.remove(&request);
        }
    }

    /// Returns whether an enabled channel serves a request.
    pub fn is_served(&self, request: Request) -> bool {
        self.served.contains(&request)
    }

    /// Sets or clears a DMA request.
    pub fn request(&mut self, request: Request, level: bool) {
        self.changed |= match level {
            true => self.requests.insert(request),
            false => self.requests.remove(&request),
        };
    }
}

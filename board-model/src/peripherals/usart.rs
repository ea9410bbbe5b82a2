//! USARTs: RM0090 section 30, with one byte in each direction, and RM0440 section 37 with RM0433 section 48, with
//! FIFOs. Asynchronous, 8 bits, no parity. The line's speed follows from clock tree and BRR; a byte that arrives before
//! the preceding one was read is lost, as on the chip. DMA can move the bytes, and an idle line sets a flag.

use std::collections::VecDeque;

use super::Peripheral;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Pin, Request, Time, Wires, cycles};

/// RM0090 30.6; UART4 and UART5 have no clock, flow control or smartcard mode.
static OLD: [Register; 7] = old(0x7f6f, 0x0fff);
static OLD_UART: [Register; 7] = old(0x706f, 0x08cf);

/// Register map with the fields of two registers. DMA moves single bytes between data registers and memory, which the
/// bus bridge widens to words (RM0090 10.3.10).
const fn old(cr2: u32, cr3: u32) -> [Register; 7] {
    [
        Register::new("USART_SR", 0x00, 0xc0, 0x3ff).special(0x3ff).half_words(),
        Register::new("USART_DR", 0x04, 0, 0x1ff).special(0x1ff).any_width(),
        Register::new("USART_BRR", 0x08, 0, 0xffff).half_words(),
        Register::new("USART_CR1", 0x0c, 0, 0xbfff).half_words(),
        Register::new("USART_CR2", 0x10, 0, cr2).half_words(),
        Register::new("USART_CR3", 0x14, 0, cr3).half_words(),
        Register::new("USART_GTPR", 0x18, 0, 0xffff).half_words(),
    ]
}

/// RM0440 37.8, RM0433 48.7.
static NEW: [Register; 12] = [
    Register::new("USART_CR1", 0x00, 0, u32::MAX),
    Register::new("USART_CR2", 0x04, 0, 0xffff_ff7f & !bits(2, 1)),
    Register::new("USART_CR3", 0x08, 0, !bit(16)),
    Register::new("USART_BRR", 0x0c, 0, 0xffff),
    Register::new("USART_GTPR", 0x10, 0, 0xffff),
    Register::new("USART_RTOR", 0x14, 0, u32::MAX),
    Register::new("USART_RQR", 0x18, 0, 0x1f).special(0x1f),
    Register::new("USART_ISR", 0x1c, 0x0080_00c0, u32::MAX).special(u32::MAX),
    Register::new("USART_ICR", 0x20, 0, 0x0012_3bff).special(0x0012_3bff),
    Register::new("USART_RDR", 0x24, 0, 0x1ff).special(0x1ff).any_width(),
    Register::new("USART_TDR", 0x28, 0, 0x1ff).special(0x1ff).any_width(),
    Register::new("USART_PRESC", 0x2c, 0, 0xf),
];

/// Bits of a byte on the line.
const BITS: u64 = 10;
/// Limit of the board's speed error before a receiver fails [thousandths]: RM0090 30.3.5 allows 3.75 percent for both
/// ends together.
const TOLERANCE: u64 = 20;

/// Generation of the USART.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// One byte in each direction.
    Old,
    /// FIFOs with this depth, once enabled [byte].
    New(usize),
}

impl Kind {
    /// Offset of the first control register.
    fn control(self) -> u32 {
        if self == Self::Old { 0x0c } else { 0x00 }
    }

    fn divider(self) -> u32 {
        if self == Self::Old { 0x08 } else { 0x0c }
    }

    /// Offset of the third control register.
    fn requests(self) -> u32 {
        if self == Self::Old { 0x14 } else { 0x08 }
    }

    /// UE in the control register.
    fn enable(self) -> u32 {
        if self == Self::Old { bit(13) } else { bit(0) }
    }
}

/// Clock of a peripheral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BusClock {
    /// Clock of the first peripheral bus.
    Low,
    /// Clock of the second peripheral bus.
    High,
}

/// Connections of a USART on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Number of the USART.
    pub number: u32,
    /// Interrupt.
    pub interrupt: usize,
    /// Clock.
    pub clock: BusClock,
    /// Possible transmit pins, with the alternate function.
    pub send: &'static [(Pin, u32)],
    /// Possible receive pins.
    pub receive: &'static [(Pin, u32)],
}

/// USART.
#[derive(Debug)]
pub struct Usart {
    registers: Registers,
    kind: Kind,
    place: Place,
    received: VecDeque<u8>,
    overrun: bool,
    idle: bool,
    /// Overrun and idle flags in the last status read; reading the data clears them.
    seen: [bool; 2],
    /// Time at which the line has been idle for a byte, unless another byte begins before.
    idle_at: Option<Time>,
    waiting: VecDeque<u8>,
    /// Byte in transmission, and the time of its end.
    sending: Option<(u8, Time)>,
}

impl Usart {
    /// USART with one byte in each direction.
    pub fn old(place: Place) -> Self {
        Self::with(Registers::new(&OLD), Kind::Old, place)
    }

    /// USART with one byte in each direction and no clock: UART4 and UART5.
    pub fn old_uart(place: Place) -> Self {
        Self::with(Registers::new(&OLD_UART), Kind::Old, place)
    }

    /// USART with FIFOs: 8 bytes on the G474, 16 on the H743.
    pub fn new(place: Place, depth: usize) -> Self {
        Self::with(Registers::new(&NEW), Kind::New(depth), place)
    }

    fn with(registers: Registers, kind: Kind, place: Place) -> Self {
        Self {
            registers,
            kind,
            place,
            received: VecDeque::new(),
            overrun: false,
            idle: false,
            seen: [false; 2],
            idle_at: None,
            waiting: VecDeque::new(),
            sending: None,
        }
    }

    fn control(&self) -> u32 {
        self.registers.get(self.kind.control())
    }

    fn is_enabled(&self) -> bool {
        self.control() & self.kind.enable() != 0
    }

    fn receives(&self, wires: &Wires) -> bool {
        self.is_enabled()
            && self.control() & bit(2) != 0
            && wires.leads_by(wires.line.cable.receive, self.place.receive)
    }

    /// Returns whether the line to the host is connected to this USART.
    fn has_line(&self, wires: &Wires) -> bool {
        wires.line.cable.unit == self.place.number
    }

    fn sends(&self) -> bool {
        self.is_enabled() && self.control() & bit(3) != 0
    }

    fn depth(&self) -> usize {
        match self.kind {
            Kind::New(depth) if self.control() & bit(29) != 0 => depth,
            _ => 1,
        }
    }

    /// Speed [baud]: RM0090 30.3.4, RM0440 37.5.7.
    fn baud(&self, wires: &Wires) -> u64 {
        let clock = match self.place.clock {
            BusClock::Low => wires.clocks.low,
            BusClock::High => wires.clocks.high,
        };
        let over_8 = self.control() & bit(15) != 0;
        let divider = u64::from(self.registers.get(self.kind.divider()));
        let prescaler = match self.kind {
            Kind::Old => 1,
            Kind::New(_) => {
                [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256][self.registers.field(0x2c, 0, 4).min(11) as usize]
            }
        };
        match over_8 {
            false => clock / prescaler / divider.max(1),
            true => 2 * clock / prescaler / (divider & 0xfff0 | divider << 1 & 0xe).max(1),
        }
    }

    fn is_off_speed(&self, wires: &Wires) -> bool {
        let (own, host) = (self.baud(wires), wires.line.cable.baud);
        own.abs_diff(host) * 1000 > TOLERANCE * host
    }

    fn has_room(&self) -> bool {
        self.waiting.len() < self.depth()
    }

    fn status(&self) -> u32 {
        let mut status = u32::from(self.overrun) << 3 | u32::from(self.idle) << 4;
        status |= u32::from(!self.received.is_empty()) << 5;
        status |= u32::from(self.sending.is_none() && self.waiting.is_empty()) << 6;
        status |= u32::from(self.has_room()) << 7;
        if let Kind::New(_) = self.kind {
            // TEACK, REACK, TXFE, RXFF.
            status |= (self.control() & bit(3)) << 18 & bit(21) | (self.control() & bit(2)) << 20 & bit(22);
            status |= u32::from(self.waiting.is_empty()) << 23;
            status |= u32::from(self.received.len() == self.depth()) << 24;
        }
        status
    }

    fn write_data(&mut self, value: u32, wires: &mut Wires) {
        if !self.sends() {
            wires.violation("USART data", "is written while nothing is sent: UE and TE first", "RM0440 37.5.5");
        } else if self.has_room() {
            self.waiting.push_back(value as u8);
        } else {
            wires.violation("USART data", "is written while it is full: the byte is lost", "RM0090 30.3.2");
        }
    }

    fn control_changed(&mut self, value: u32, before: u32, wires: &mut Wires) {
        let enable = self.kind.enable();
        let receives = |control: u32| control & enable != 0 && control & bit(2) != 0;
        if receives(value) && !receives(before) {
            self.falls_silent(wires.now, wires);
        } else if !receives(value) {
            self.idle_at = None;
        }
        if let Kind::New(_) = self.kind {
            // RM0440 37.8.1: these fields can be written only while the USART is off.
            let fixed = bit(29) | bit(28) | bit(15) | bit(12) | bits(11, 9);
            if before & enable != 0 && (value ^ before) & fixed != 0 {
                wires.violation(
                    "USART_CR1",
                    "word length, parity, oversampling or FIFO changed while UE is 1",
                    "RM0440 37.8.1",
                );
            }
        }
        if value & enable != 0 && before & enable == 0 {
            if self.registers.get(self.kind.divider()) < 16 {
                wires.violation("USART_BRR", "is below 16 when the USART is enabled", "RM0440 37.5.7");
            }
            for (pins, what) in [(self.place.send, "sends"), (self.place.receive, "receives")] {
                if !wires.leads_to(pins) {
                    let what = format!("the USART is enabled while no pin that {what} is routed to it");
                    wires.violation("USART_CR1", what, "RM0090 8.3.2");
                }
            }
            let pulled = [Pin('B', 4), Pin('B', 6)];
            let is_on = |pin: &Pin| wires.leads_by(*pin, self.place.send) || wires.leads_by(*pin, self.place.receive);
            if wires.pulls_down_for_usb && pulled.iter().any(is_on) {
                let what = "a pin of the USART is pulled down for an empty battery on USB: UCPD1_DBDIS is 0";
                wires.violation("PWR_CR3", what, "RM0440 6.4.3");
            }
            if self.is_off_speed(wires) {
                let what = format!("gives {} baud where the host has {}", self.baud(wires), wires.line.cable.baud);
                wires.violation("USART_BRR", what, "RM0090 30.3.4");
            }
        }
    }

    fn start_sending(&mut self, now: Time, wires: &Wires) {
        if self.sends()
            && let Some(byte) = self.waiting.pop_front()
        {
            self.sending = Some((byte, now + cycles(BITS, self.baud(wires))));
        }
    }

    /// Sets the idle flag if the line was silent for a byte's time (RM0090 30.3.3, RM0440 37.5.6), up to now or to the
    /// start of the next byte.
    fn watch_silence(&mut self, begun: Option<Time>, now: Time) {
        let Some(idle_at) = self.idle_at else { return };
        if begun.is_some_and(|begun| begun < idle_at) {
            self.idle_at = None;
        } else if idle_at <= now {
            (self.idle, self.idle_at) = (true, None);
        }
    }

    /// Records that the line is silent from a time on.
    fn falls_silent(&mut self, now: Time, wires: &Wires) {
        self.idle_at = Some(now + cycles(BITS, self.baud(wires)));
    }

    /// Receives a complete byte.
    fn arrive(&mut self, byte: u8, at: Time, wires: &mut Wires) {
        // A wrong speed garbles the byte.
        let byte = if self.is_off_speed(wires) { !byte } else { byte };
        if !self.receives(wires) {
            return;
        }
        self.falls_silent(at, wires);
        if self.received.len() < self.depth() {
            self.received.push_back(byte);
        } else {
            self.overrun = true;
            wires.line.overruns += 1;
        }
    }
}

impl Peripheral for Usart {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        match (self.kind, offset) {
            (Kind::Old, 0x00) => {
                self.seen = [self.overrun, self.idle];
                self.status()
            }
            (Kind::New(_), 0x1c) => self.status(),
            (Kind::Old, 0x04) | (Kind::New(_), 0x24) => {
                // RM0090 30.6.1: reading status, then data, by core or DMA, clears overrun and idle.
                let [overrun, idle] = std::mem::take(&mut self.seen);
                self.overrun &= !overrun;
                self.idle &= !idle;
                let byte = self.received.pop_front().unwrap_or_default();
                self.advance(wires);
                byte.into()
            }
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        self.advance(wires);
        match (self.kind, offset) {
            (Kind::Old, 0x04) | (Kind::New(_), 0x28) => self.write_data(value, wires),
            (kind, offset) if offset == kind.control() => self.control_changed(value, before, wires),
            // RM0440 37.8.5: the divider is written while the USART is off.
            (Kind::New(_), 0x0c) if self.is_enabled() => {
                wires.violation("USART_BRR", "is written while UE is 1", "RM0440 37.8.5");
            }
            (Kind::New(_), 0x20) => {
                self.overrun &= value & bit(3) == 0;
                self.idle &= value & bit(4) == 0;
            }
            (Kind::New(_), 0x18) if value & bit(3) != 0 => self.received.clear(),
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        while let Some((byte, done)) = self.sending.filter(|(_, done)| *done <= wires.now) {
            let byte = if self.is_off_speed(wires) { !byte } else { byte };
            if self.has_line(wires) && wires.leads_by(wires.line.cable.send, self.place.send) {
                wires.line.to_host.push(byte);
            }
            self.sending = None;
            self.start_sending(done, wires);
        }
        if self.sending.is_none() {
            self.start_sending(wires.now, wires);
        }
        let has_line = self.has_line(wires);
        let asks_for_dma = self.is_enabled() && self.registers.get(self.kind.requests()) & bit(6) != 0;
        let is_served = asks_for_dma && wires.is_served(Request::UsartReceived(self.place.number));
        while let Some(arrives) = wires.line.arrives.filter(|arrives| has_line && *arrives <= wires.now) {
            // While the core stands still, DMA takes its turn after every byte.
            if is_served && !self.received.is_empty() {
                break;
            }
            let start = arrives.saturating_sub(cycles(BITS, wires.line.cable.baud));
            self.watch_silence(Some(start), arrives);
            let byte = wires.line.to_board.pop_front().unwrap_or_default();
            self.arrive(byte, arrives, wires);
            let next = arrives + cycles(BITS, wires.line.cable.baud);
            wires.line.arrives = (!wires.line.to_board.is_empty()).then_some(next);
        }
        if has_line && wires.line.arrives.is_none() && !wires.line.to_board.is_empty() {
            wires.line.arrives = Some(wires.now + cycles(BITS, wires.line.cable.baud));
        }
        let arrives = wires.line.arrives.filter(|_| has_line);
        let start = arrives.map(|arrives| arrives.saturating_sub(cycles(BITS, wires.line.cable.baud)));
        self.watch_silence(start, wires.now);
        let (status, control) = (self.status(), self.control());
        let requests = self.registers.get(self.kind.requests());
        let receive = control & bit(5) != 0 && status & (bit(5) | bit(3)) != 0;
        let send = control & bit(7) != 0 && status & bit(7) != 0;
        let done = control & bit(6) != 0 && status & bit(6) != 0;
        let idle = control & bit(4) != 0 && status & bit(4) != 0;
        // RM0090 30.6.6: EIE applies with DMA only; RM0440 37.8.4: without DMA too.
        let errs = requests & bit(0) != 0 && (self.kind != Kind::Old || requests & bit(6) != 0) && self.overrun;
        wires.interrupt(self.place.interrupt, self.is_enabled() && (receive || send || done || idle || errs));
        let number = self.place.number;
        wires.request(Request::UsartReceived(number), asks_for_dma && status & bit(5) != 0);
        wires.request(Request::UsartToSend(number), self.sends() && requests & status & bit(7) != 0);
    }

    fn next_event(&self) -> Option<Time> {
        self.sending.map(|(_, done)| done).into_iter().chain(self.idle_at).min()
    }

    fn reset(&mut self) {
        self.registers.reset();
        *self = Self::with(self.registers.clone(), self.kind, self.place);
    }
}

//! SPI as a slave: RM0090 section 28, with room for one byte each way, and RM0440 section 39, with FIFOs of four bytes. Mode
//! 0, 8 bits, chip select by its pin. The master is outside, in the wires.

use std::collections::VecDeque;

use super::Peripheral;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Pin, Request, Wires};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
const DR: u32 = 0x0c;

/// RM0090 28.5.
static OLD: [Register; 9] = [
    Register::new("SPI_CR1", CR1, 0, 0xffff).half_words(),
    Register::new("SPI_CR2", CR2, 0, 0xf7).half_words(),
    Register::new("SPI_SR", SR, 2, 0x1ff).special(0x1ff).half_words(),
    Register::new("SPI_DR", DR, 0, 0xffff).special(0xffff).any_width(),
    Register::new("SPI_CRCPR", 0x10, 7, 0xffff).half_words(),
    Register::new("SPI_RXCRCR", 0x14, 0, 0xffff).special(0xffff).half_words(),
    Register::new("SPI_TXCRCR", 0x18, 0, 0xffff).special(0xffff).half_words(),
    Register::new("SPI_I2SCFGR", 0x1c, 0, 0x0fbf).half_words(),
    Register::new("SPI_I2SPR", 0x20, 2, 0x03ff).half_words(),
];
/// RM0440 39.8.
static NEW: [Register; 9] = [
    Register::new("SPI_CR1", CR1, 0, 0xffff).half_words(),
    Register::new("SPI_CR2", CR2, 0x0700, 0x7fff).half_words(),
    Register::new("SPI_SR", SR, 2, 0x1fff).special(0x1fff).half_words(),
    Register::new("SPI_DR", DR, 0, 0xffff).special(0xffff).any_width(),
    Register::new("SPI_CRCPR", 0x10, 7, 0xffff).half_words(),
    Register::new("SPI_RXCRCR", 0x14, 0, 0xffff).special(0xffff).half_words(),
    Register::new("SPI_TXCRCR", 0x18, 0, 0xffff).special(0xffff).half_words(),
    Register::new("SPI_I2SCFGR", 0x1c, 0, 0x1fbf).half_words(),
    Register::new("SPI_I2SPR", 0x20, 2, 0x03ff).half_words(),
];

/// Where it is on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Its number.
    pub number: u32,
    /// Chip select, clock, to the master, from the master, each with its alternate function.
    pub pins: [(Pin, u32); 4],
}

/// An SPI.
#[derive(Debug)]
pub struct Spi {
    registers: Registers,
    place: Place,
    has_fifos: bool,
    received: VecDeque<u8>,
    to_send: VecDeque<u8>,
    overrun: bool,
    /// The data was read since the overrun: a read of the status then clears it.
    data_read: bool,
}

impl Spi {
    /// One byte each way.
    pub fn old(place: Place) -> Self {
        Self::with(&OLD, false, place)
    }

    /// FIFOs of four bytes.
    pub fn new(place: Place) -> Self {
        Self::with(&NEW, true, place)
    }

    fn with(table: &'static [Register], has_fifos: bool, place: Place) -> Self {
        let registers = Registers::new(table);
        let (received, to_send) = (VecDeque::new(), VecDeque::new());
        Self { registers, place, has_fifos, received, to_send, overrun: false, data_read: false }
    }

    fn is_on(&self) -> bool {
        self.registers.is_set(CR1, 6)
    }

    fn depth(&self) -> usize {
        if self.has_fifos { 4 } else { 1 }
    }

    /// RXNE: with FIFOs from one byte on if FRXTH is 1, else from two (RM0440 39.4.10).
    fn has_received(&self) -> bool {
        let least = if self.has_fifos && !self.registers.is_set(CR2, 12) { 2 } else { 1 };
        self.received.len() >= least
    }

    /// TXE: with FIFOs up to half of one.
    fn has_room(&self) -> bool {
        self.to_send.len() <= if self.has_fifos { 2 } else { 0 }
    }

    /// RXDMAEN or TXDMAEN.
    fn wants_transfer(&self) -> bool {
        self.registers.get(CR2) & 3 != 0
    }

    /// Pins that a slave cannot do without.
    fn is_routed(&self, wires: &Wires) -> bool {
        self.place.pins.iter().all(|pin| wires.leads_to(&[*pin]))
    }

    /// The master clocks a byte each way.
    fn exchange(&mut self, byte: u8, wires: &mut Wires) -> u8 {
        let master = self.registers.is_set(CR1, 2);
        if !self.is_on() || master || !self.is_routed(wires) || wires.level(self.place.pins[0].0) {
            return 0xff;
        }
        if self.received.len() < self.depth() {
            self.received.push_back(byte);
        } else {
            (self.overrun, self.data_read) = (true, false);
        }
        // An empty one sends what the line happens to hold.
        self.to_send.pop_front().unwrap_or(0xff)
    }

    fn configured(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        if offset == CR1 && before & bit(6) != 0 && (value ^ before) & (bits(5, 0) & !bit(2) | bit(7)) != 0 {
            wires.violation("SPI_CR1", "clock or bit order are changed while SPE is 1", "RM0440 39.8.1");
        }
        if offset == CR1 && value & bit(6) != 0 && before & bit(6) == 0 && !self.is_routed(wires) {
            wires.violation("SPI_CR1", "a slave is switched on while its pins are not routed to it", "RM0090 28.3.2");
        }
        if offset == CR2 && self.has_fifos {
            let number = self.place.number;
            if value & !before & bit(0) != 0 && wires.is_served(Request::SpiReceived(number)) {
                let what = "RXDMAEN is set after the channel that receives: before it is the order";
                wires.violation("SPI_CR2", what, "RM0440 39.4.9, DMA");
            } else if value & !before & bit(1) != 0 && !wires.is_served(Request::SpiToSend(number)) {
                let what = "TXDMAEN is set before the channel that sends: after it is the order";
                wires.violation("SPI_CR2", what, "RM0440 39.4.9, DMA");
            }
        }
    }
}

impl Peripheral for Spi {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        match offset {
            SR => {
                let levels = [self.received.len() as u32, self.to_send.len() as u32];
                let fifos = if self.has_fifos { levels[0].min(3) << 9 | levels[1].min(3) << 11 } else { 0 };
                let overrun = self.overrun;
                // RM0090 28.3.10: a read of the data and then of the status clears it.
                if std::mem::take(&mut self.data_read) {
                    self.overrun = false;
                }
                u32::from(self.has_received()) | u32::from(self.has_room()) << 1 | u32::from(overrun) << 6 | fifos
            }
            DR => {
                self.data_read = true;
                self.received.pop_front().unwrap_or(0).into()
            }
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            DR if self.to_send.len() < self.depth() => self.to_send.push_back(value as u8),
            DR => wires.violation("SPI_DR", "is written while it is full: the byte is lost", "RM0090 28.3.7"),
            CR1 | CR2 => self.configured(offset, value, before, wires),
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        while let Some(byte) = wires.master.due(self.place.number, wires.now) {
            let answer = self.exchange(byte, wires);
            wires.master.received.push(answer);
            // DMA has its turn after every byte.
            if self.wants_transfer() {
                break;
            }
        }
        let number = self.place.number;
        let receive = self.registers.is_set(CR2, 0) && self.has_received();
        let send = self.registers.is_set(CR2, 1) && self.has_room();
        wires.request(Request::SpiReceived(number), receive);
        wires.request(Request::SpiToSend(number), send);
    }

    fn reset(&mut self) {
        let table = if self.has_fifos { &NEW } else { &OLD };
        *self = Self::with(table, self.has_fifos, self.place);
    }
}

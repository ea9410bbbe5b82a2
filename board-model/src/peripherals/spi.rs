//! SPI: RM0090 section 28, with one frame in each direction, and RM0440 section 39, with FIFOs of four bytes. As a
//! slave in mode 0 with 8 bits, with the external master in `wires`; as a master in any mode with 8 or 16 bits, with
//! the external slave in `wires`.

use std::collections::VecDeque;

use super::Peripheral;
use super::usart::BusClock;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Pin, Request, Time, Wires, cycles};

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

/// CR1: master, enable, level of the software select, and software select enable.
const MSTR: u32 = bit(2);
const SPE: u32 = bit(6);
const SSI: u32 = 8;
const SSM: u32 = 9;
/// CR1 and CR2 bits that are not modelled: receive only, checksums, single data line; other frame formats, select
/// pulses, interrupts.
const LEFT_OUT: [u32; 2] = [bit(10) | bit(12) | bit(13) | bit(14) | bit(15), bits(7, 3)];
/// CR2: select as an output.
const SSOE: u32 = bit(2);

/// Connections of an SPI on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Number of the SPI.
    pub number: u32,
    /// Bus clock from which its speed is divided.
    pub clock: BusClock,
    /// Pins for chip select, clock, data to the master, data from the master, each with its alternate function.
    pub pins: [(Pin, u32); 4],
}

/// Frame in transmission as a master.
#[derive(Debug, Clone)]
struct Shift {
    ends: Time,
    received: Vec<u8>,
}

/// SPI.
#[derive(Debug)]
pub struct Spi {
    registers: Registers,
    place: Place,
    has_fifos: bool,
    received: VecDeque<u8>,
    to_send: VecDeque<u8>,
    shift: Option<Shift>,
    overrun: bool,
    /// True if the data was read since the overrun: reading the status then clears it.
    data_read: bool,
    /// MODF, and true if the status was read since: writing CR1 then clears it.
    mode_fault: bool,
    fault_read: bool,
}

impl Spi {
    /// SPI with one frame in each direction.
    pub fn old(place: Place) -> Self {
        Self::with(&OLD, false, place)
    }

    /// SPI with FIFOs of four bytes.
    pub fn new(place: Place) -> Self {
        Self::with(&NEW, true, place)
    }

    fn with(table: &'static [Register], has_fifos: bool, place: Place) -> Self {
        Self {
            registers: Registers::new(table),
            place,
            has_fifos,
            received: VecDeque::new(),
            to_send: VecDeque::new(),
            shift: None,
            overrun: false,
            data_read: false,
            mode_fault: false,
            fault_read: false,
        }
    }

    fn is_on(&self) -> bool {
        self.registers.get(CR1) & SPE != 0
    }

    fn is_master(&self) -> bool {
        self.registers.get(CR1) & MSTR != 0
    }

    /// Bytes of a frame: DFF (RM0090 28.5.1), DS (RM0440 39.8.2).
    fn frame(&self) -> usize {
        let is_long =
            if self.has_fifos { self.registers.field(CR2, 8, 4) == 15 } else { self.registers.is_set(CR1, 11) };
        if is_long { 2 } else { 1 }
    }

    fn depth(&self) -> usize {
        if self.has_fifos { 4 } else { self.frame() }
    }

    /// RXNE: with FIFOs from one byte on if FRXTH is 1, else from two (RM0440 39.4.10).
    fn has_received(&self) -> bool {
        let least = if self.has_fifos && !self.registers.is_set(CR2, 12) { 2 } else { self.frame() };
        self.received.len() >= least
    }

    /// TXE: with FIFOs while the transmit FIFO is at most half full.
    fn has_room(&self) -> bool {
        self.to_send.len() <= if self.has_fifos { 2 } else { 0 }
    }

    /// RXDMAEN or TXDMAEN.
    fn wants_transfer(&self) -> bool {
        self.registers.get(CR2) & 3 != 0
    }

    /// Returns whether all required pins are routed; select is not required if software gives it.
    fn is_routed(&self, wires: &Wires) -> bool {
        let by_software = usize::from(self.registers.is_set(CR1, SSM));
        self.place.pins[by_software..].iter().all(|pin| wires.leads_to(&[*pin]))
    }

    /// Level of the select (RM0090 28.3.1, RM0440 39.4.5).
    fn select(&self, wires: &Wires) -> bool {
        if self.registers.is_set(CR1, SSM) {
            self.registers.is_set(CR1, SSI)
        } else {
            wires.level(self.place.pins[0].0)
        }
    }

    /// Exchanges a byte with the external master.
    fn exchange(&mut self, byte: u8, wires: &mut Wires) -> u8 {
        if !self.is_on() || self.is_master() || !self.is_routed(wires) || self.select(wires) {
            return 0xff;
        }
        self.take(&[byte]);
        // An empty transmit buffer sends whatever is on the line.
        self.to_send.pop_front().unwrap_or(0xff)
    }

    /// Stores a received frame, or sets the overrun flag.
    fn take(&mut self, frame: &[u8]) {
        if self.received.len() + frame.len() <= self.depth() {
            self.received.extend(frame);
        } else {
            (self.overrun, self.data_read) = (true, false);
        }
    }

    /// Starts the next frame as a master, if there is one.
    fn begin(&mut self, now: Time, wires: &mut Wires) {
        let bytes = self.frame();
        if !self.is_on() || !self.is_master() || self.shift.is_some() || self.to_send.len() < bytes {
            return;
        }
        let bus = match self.place.clock {
            BusClock::Low => wires.clocks.low,
            BusClock::High => wires.clocks.high,
        };
        // BR: 2 to 256.
        let rate = bus >> (self.registers.field(CR1, 3, 3) + 1);
        let mode = (self.registers.is_set(CR1, 1), self.registers.is_set(CR1, 0));
        // Of a long frame the lower byte is written first, but the higher byte is sent first.
        let mut frame: Vec<u8> = self.to_send.drain(..bytes).collect();
        let low_first = self.registers.is_set(CR1, 7);
        frame.reverse();
        let turned = |byte: u8| if low_first { byte.reverse_bits() } else { byte };
        if low_first {
            frame.reverse();
        }
        let number = self.place.number;
        let clock = |byte: &u8| turned(wires.clock_slave(number, turned(*byte), mode, cycles(1, rate), now));
        let mut received: Vec<u8> = frame.iter().map(clock).collect();
        if !low_first {
            received.reverse();
        }
        self.shift = Some(Shift { ends: now + cycles(8 * bytes as u64, rate), received });
    }

    /// Completes finished frames as a master and starts the following ones.
    fn go_on(&mut self, wires: &mut Wires) {
        while let Some(shift) = self.shift.take_if(|shift| shift.ends <= wires.now) {
            self.take(&shift.received);
            self.begin(shift.ends, wires);
        }
    }

    /// MODF: a low select ends the master role (RM0090 28.3.10, RM0440 39.4.11).
    fn look_at_select(&mut self, wires: &mut Wires) {
        let is_output = self.registers.get(CR2) & SSOE != 0 && !self.registers.is_set(CR1, SSM);
        if self.is_on() && self.is_master() && !is_output && !self.select(wires) {
            (self.mode_fault, self.fault_read) = (true, false);
            self.registers.change(CR1, 0, MSTR | SPE);
        }
    }

    fn configured(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        let left_out = LEFT_OUT[usize::from(offset == CR2)];
        if value & left_out != 0 {
            let what = format!("bits {:#06x} are set, which the model leaves out", value & left_out);
            wires.violation(if offset == CR1 { "SPI_CR1" } else { "SPI_CR2" }, what, "RM0090 28.5, RM0440 39.8");
        }
        if offset == CR2 && self.has_fifos && ![7, 15].contains(&(value >> 8 & 0xf)) {
            wires.violation("SPI_CR2", "frames of neither 8 nor 16 bits are left out", "RM0440 39.8.2 DS");
        }
        let was_on = before & SPE != 0;
        if offset == CR1 {
            if was_on && (value ^ before) & (bits(5, 0) | bit(7)) != 0 {
                wires.violation("SPI_CR1", "clock, order or role are changed while SPE is 1", "RM0440 39.8.1");
            }
            if was_on && value & SPE == 0 && self.shift.is_some() {
                wires.violation("SPI_CR1", "is switched off while BSY is 1", "RM0090 28.3.8, RM0440 39.4.9");
                self.shift = None;
            }
            if value & SPE != 0 && !was_on && !self.is_routed(wires) {
                wires.violation("SPI_CR1", "is switched on while its pins are not routed to it", "RM0090 28.3.2");
            }
            if std::mem::take(&mut self.fault_read) {
                self.mode_fault = false;
            }
            if self.mode_fault && value & (SPE | MSTR) != 0 {
                wires.violation("SPI_CR1", "SPE or MSTR are set while MODF is", "RM0090 28.3.10, RM0440 39.4.11");
                self.registers.change(CR1, 0, MSTR | SPE);
            }
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

    /// Number of bytes that a data access moves: FIFOs move two 8-bit frames in a wider access (RM0440 39.4.10).
    fn moved(&self, wires: &mut Wires) -> usize {
        let frame = self.frame();
        if (wires.width as usize) < frame {
            wires.violation("SPI_DR", "a frame of 16 bits is accessed by 8", "RM0090 28.5.4, RM0440 39.8.4");
        }
        if self.has_fifos && wires.width > 1 { 2 } else { frame }
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
                let (overrun, fault) = (self.overrun, self.mode_fault);
                // RM0090 28.3.10: reading data, then status, clears the overrun.
                if std::mem::take(&mut self.data_read) {
                    self.overrun = false;
                }
                self.fault_read = fault;
                u32::from(self.has_received())
                    | u32::from(self.has_room()) << 1
                    | u32::from(fault) << 5
                    | u32::from(overrun) << 6
                    | u32::from(self.shift.is_some()) << 7
                    | fifos
            }
            DR => {
                self.data_read = true;
                let count = self.moved(wires).min(self.received.len());
                let bytes = self.received.drain(..count);
                bytes.enumerate().map(|(place, byte)| u32::from(byte) << (8 * place)).sum()
            }
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            DR => {
                let count = self.moved(wires);
                if self.to_send.len() + count <= self.depth() {
                    self.to_send.extend(&value.to_le_bytes()[..count]);
                } else {
                    wires.violation("SPI_DR", "is written while it is full: the data is lost", "RM0090 28.3.7");
                }
            }
            CR1 | CR2 => self.configured(offset, value, before, wires),
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        while let Some(byte) = wires.master.due(self.place.number, wires.now) {
            let answer = self.exchange(byte, wires);
            wires.master.received.push(answer);
            // DMA takes its turn after every byte.
            if self.wants_transfer() {
                break;
            }
        }
        self.go_on(wires);
        self.look_at_select(wires);
        self.begin(wires.now, wires);
        let number = self.place.number;
        let receive = self.registers.is_set(CR2, 0) && self.has_received();
        let send = self.registers.is_set(CR2, 1) && self.has_room();
        wires.request(Request::SpiReceived(number), receive);
        wires.request(Request::SpiToSend(number), send);
    }

    fn next_event(&self) -> Option<Time> {
        self.shift.as_ref().map(|shift| shift.ends)
    }

    fn reset(&mut self) {
        let table = if self.has_fifos { &NEW } else { &OLD };
        *self = Self::with(table, self.has_fifos, self.place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::as5047p::As5047p;
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::BASE;
    use crate::wires::{Cable, MICROSECOND, Surroundings};

    const SPI1: u32 = 0x4001_3000;
    const SPI2: u32 = 0x4000_3800;
    /// Software select, high; 4 MHz from 16; mode 1; enabled.
    const MASTER: u32 = 1 << 9 | 1 << 8 | 1 << 6 | 1 << 3 | 1 << 2 | 1;
    const BUSY: u64 = 1 << 7;
    const OVERRUN: u64 = 1 << 6;
    const MODE_FAULT: u64 = 1 << 5;

    fn f405() -> Machine {
        let mut machine =
            Machine::new(chips::f405::chip(BASE + 0x1000), Surroundings::default(), Cable::default(), 1000);
        machine.settle();
        for (address, value) in [
            (0x4002_3830, 1 << 20 | 1),
            (0x4002_3844, 1 << 12),
            (0x4002_0018, 1 << 4),
            (0x4002_0020, 0x5550_0000),
            (0x4002_0000, 0xa800_0000 | 0b1010_1001 << 8),
        ] {
            machine.set_up(address, value);
        }
        machine
    }

    fn g474() -> Machine {
        let mut machine =
            Machine::new(chips::g474::chip(BASE + 0x1000), Surroundings::default(), Cable::default(), 1000);
        machine.settle();
        for (address, value) in [
            (0x4002_104c, 1 << 1),
            (0x4002_1058, 1 << 14 | 1 << 10),
            (0x4800_0418, 1 << 12),
            (0x4800_0424, 0x5550_0000),
            (0x4800_0400, 0x00ff_febf | 0b1010_1001 << 24),
        ] {
            machine.set_up(address, value);
        }
        machine
    }

    fn pass(machine: &mut Machine, duration: Time) {
        machine.pass(duration);
        machine.settle();
    }

    fn said(machine: &Machine) -> Vec<&str> {
        machine.wires.violations.all().iter().map(|violation| violation.what.as_str()).collect()
    }

    #[test]
    fn full_duplex_byte_takes_its_time() {
        for (mut machine, base) in [(f405(), SPI1), (g474(), SPI2)] {
            machine.write(base + 4, 4, if base == SPI2 { 0x1700 } else { 0 });
            machine.write(base, 4, MASTER.into());
            assert_eq!(machine.read(base + 8, 4) & 0b11, 0b10);
            machine.write(base + 12, 1, 0x55);
            assert_eq!(machine.read(base + 8, 4) & (BUSY | 0b11), BUSY | 0b10);
            pass(&mut machine, 2 * MICROSECOND - MICROSECOND / 4);
            assert_eq!(machine.read(base + 8, 4) & 1, 0);
            pass(&mut machine, MICROSECOND / 4);
            // No slave answers: the line is high.
            assert_eq!(machine.read(base + 8, 4) & (BUSY | 0b11), 0b11);
            assert_eq!((machine.read(base + 12, 1), machine.read(base + 8, 4) & 1), (0xff, 0));
            assert_eq!(said(&machine), [""; 0]);
        }
    }

    /// Until data and status are read.
    #[test]
    fn overrun_reported_until_read() {
        let mut machine = f405();
        machine.write(SPI1, 4, MASTER.into());
        for _ in 0..2 {
            machine.write(SPI1 + 12, 1, 1);
            pass(&mut machine, 3 * MICROSECOND);
        }
        assert_eq!(machine.read(SPI1 + 8, 4) & OVERRUN, OVERRUN);
        machine.read(SPI1 + 12, 1);
        machine.read(SPI1 + 8, 4);
        assert_eq!(machine.read(SPI1 + 8, 4) & OVERRUN, 0);
        // FIFOs hold four bytes, and the fifth is lost.
        let mut machine = g474();
        machine.write(SPI2 + 4, 4, 0x1700);
        machine.write(SPI2, 4, MASTER.into());
        for count in 1..=5 {
            machine.write(SPI2 + 12, 1, 1);
            pass(&mut machine, 3 * MICROSECOND);
            assert_eq!(machine.read(SPI2 + 8, 4) & OVERRUN, if count == 5 { OVERRUN } else { 0 }, "{count}");
        }
    }

    /// Until status is read and control is written.
    #[test]
    fn low_select_ends_master_mode() {
        let mut machine = f405();
        machine.write(SPI1, 4, (MASTER & !(1 << 8)).into());
        assert_eq!(machine.read(SPI1, 4) as u32 & (MSTR | SPE), 0);
        machine.write(SPI1, 4, MASTER.into());
        assert_eq!(said(&machine), ["SPE or MSTR are set while MODF is"]);
        assert_eq!(machine.read(SPI1 + 8, 4) & MODE_FAULT, MODE_FAULT);
        machine.write(SPI1, 4, MASTER.into());
        assert_eq!(machine.read(SPI1 + 8, 4) & MODE_FAULT, 0);
        assert_eq!(machine.read(SPI1, 4) as u32 & (MSTR | SPE), MSTR | SPE);
        // Select by its pin, here an output of the port: the level of the pin counts.
        let mut machine = f405();
        machine.write(0x4002_0018, 4, 1 << 20);
        machine.write(SPI1, 4, (MASTER & !(0b11 << 8)).into());
        assert_eq!(machine.read(SPI1 + 8, 4) & MODE_FAULT, MODE_FAULT);
    }

    /// Frames of 16 bits go high byte first; one access writes two frames of 8 bits.
    #[test]
    fn frame_widths_and_byte_order() {
        let mut machine = f405();
        machine.wires.encoder = Some(As5047p::new(1, Pin('A', 4)));
        if let Some(encoder) = &mut machine.wires.encoder {
            encoder.angle = 0x1235;
        }
        machine.write(SPI1, 4, (MASTER & !SPE | 1 << 11).into());
        machine.write(SPI1, 4, (MASTER | 1 << 11).into());
        pass(&mut machine, MICROSECOND);
        let frame = |machine: &mut Machine| {
            machine.write(0x4002_0018, 4, 1 << 20);
            pass(machine, MICROSECOND);
            machine.write(SPI1 + 12, 2, 0xffff);
            pass(machine, 5 * MICROSECOND);
            machine.write(0x4002_0018, 4, 1 << 4);
            pass(machine, MICROSECOND);
            machine.read(SPI1 + 12, 2)
        };
        frame(&mut machine);
        assert_eq!(frame(&mut machine), 0x1235);
        assert_eq!(said(&machine), [""; 0]);
        machine.write(SPI1 + 12, 1, 0xff);
        assert_eq!(said(&machine), ["a frame of 16 bits is accessed by 8"]);
        let mut machine = g474();
        machine.write(SPI2, 4, MASTER.into());
        machine.write(SPI2 + 12, 2, 0x0201);
        pass(&mut machine, 3 * MICROSECOND);
        assert_eq!(machine.read(SPI2 + 8, 4) & BUSY, BUSY);
        pass(&mut machine, 2 * MICROSECOND);
        assert_eq!((machine.read(SPI2 + 12, 2), machine.read(SPI2 + 8, 4) & (BUSY | 1)), (0xffff, 0));
    }

    /// And is switched off only while no transfer runs.
    #[test]
    fn spi_configured_while_off() {
        let mut machine = f405();
        machine.write(SPI1, 4, MASTER.into());
        machine.write(SPI1, 4, (MASTER | 7 << 3).into());
        machine.write(SPI1 + 12, 1, 1);
        machine.write(SPI1, 4, (MASTER & !SPE).into());
        let told = said(&machine);
        assert!(told.contains(&"clock, order or role are changed while SPE is 1"), "{told:?}");
        assert!(told.contains(&"is switched off while BSY is 1"), "{told:?}");
    }
}

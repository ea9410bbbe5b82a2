//! FDCAN of STM32G4: RM0440 44. Transmit FIFO, receive FIFO 0, message RAM, errors, bus-off, second bit rate. Filters of
//! the message RAM, FIFO 1, the transmit event FIFO, restricted operation and monitoring are not modelled: setting them
//! up is a violation, and so is what the errata forbid (ES0430).

use std::collections::VecDeque;

use drives::Frame;
use drives::frame::{Id, Kind, extended, standard};

use super::Peripheral;
use super::can_node::{CanNode, OFF, PASSIVE, WARNING};
use crate::can_bus::Node;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Gate, Pin, Time, Wires};

const DBTP: u32 = 0x0c;
const CCCR: u32 = 0x18;
const NBTP: u32 = 0x1c;
const ECR: u32 = 0x40;
const PSR: u32 = 0x44;
const TDCR: u32 = 0x48;
const IR: u32 = 0x50;
const IE: u32 = 0x54;
const ILS: u32 = 0x58;
const ILE: u32 = 0x5c;
const RXGFC: u32 = 0x80;
const RXF0S: u32 = 0x90;
const RXF0A: u32 = 0x94;
const TXFQS: u32 = 0xc4;
const TXBRP: u32 = 0xc8;
const TXBAR: u32 = 0xcc;

const INIT: u32 = bit(0);
const CCE: u32 = bit(1);

/// Elements of a FIFO.
const DEPTH: usize = 3;
/// Parts of the message RAM [byte] (44.3.3), and its size.
const FIFO_0: u32 = 0xb0;
const SEND_FIFO: u32 = 0x278;
const ELEMENT: u32 = 72;
const RAM: u32 = 0x350;

/// Data lengths by code.
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

static TABLE: [Register; 28] = [
    Register::new("FDCAN_DBTP", DBTP, 0x0000_0a33, 0x009f_1fff),
    Register::new("FDCAN_TEST", 0x10, 0, 0),
    Register::new("FDCAN_RWD", 0x14, 0, 0xffff),
    Register::new("FDCAN_CCCR", CCCR, 1, 0xf3ff),
    Register::new("FDCAN_NBTP", NBTP, 0x0600_0a03, 0xffff_ff7f),
    Register::new("FDCAN_TSCC", 0x20, 0, 0x000f_0003),
    Register::new("FDCAN_TSCV", 0x24, 0, 0xffff).special(0xffff),
    Register::new("FDCAN_TOCC", 0x28, 0xffff_0000, 0xffff_0007),
    Register::new("FDCAN_ECR", ECR, 0, 0x00ff_ffff).special(0x00ff_ffff),
    Register::new("FDCAN_PSR", PSR, 0x707, 0x007f_7fff).special(0x007f_7fff),
    Register::new("FDCAN_TDCR", TDCR, 0, 0x7f7f),
    Register::new("FDCAN_IR", IR, 0, 0x00ff_ffff).special(0x00ff_ffff),
    Register::new("FDCAN_IE", IE, 0, 0x00ff_ffff),
    Register::new("FDCAN_ILS", ILS, 0, 0x7f),
    Register::new("FDCAN_ILE", ILE, 0, 3),
    Register::new("FDCAN_RXGFC", RXGFC, 0, 0x0f1f_033f),
    Register::new("FDCAN_XIDAM", 0x84, 0x1fff_ffff, 0x1fff_ffff),
    Register::new("FDCAN_RXF0S", RXF0S, 0, 0x0303_030f).special(0x0303_030f),
    Register::new("FDCAN_RXF0A", RXF0A, 0, 7),
    Register::new("FDCAN_RXF1S", 0x98, 0, 0x0303_030f).special(0x0303_030f),
    Register::new("FDCAN_TXBC", 0xc0, 0, bit(24)),
    Register::new("FDCAN_TXFQS", TXFQS, 3, 0x0023_0307).special(0x0023_0307),
    Register::new("FDCAN_TXBRP", TXBRP, 0, 7).special(7),
    Register::new("FDCAN_TXBAR", TXBAR, 0, 7).special(7),
    Register::new("FDCAN_TXBTO", 0xd4, 0, 7).special(7),
    Register::new("FDCAN_TXBTIE", 0xdc, 0, 7),
    Register::new("FDCAN_TXEFS", 0xe4, 0, 0x0303_0307).special(0x0303_0307),
    Register::new("FDCAN_CKDIV", 0x100, 0, 0xf),
];

/// Connections of an FDCAN on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Number of the peripheral.
    pub number: u32,
    /// First address of its message RAM.
    pub ram: u32,
    /// Interrupt of line 0.
    pub interrupt: usize,
    /// Clock gate of peripheral and message RAM.
    pub clock: Gate,
    /// Register of the clock controller that selects the clock, and the bit pair's place: 2 is the bus clock.
    pub selection: (u32, u32),
    /// Possible transmit pins, with the alternate function.
    pub send: &'static [(Pin, u32)],
    /// Possible receive pins.
    pub receive: &'static [(Pin, u32)],
}

/// FDCAN.
#[derive(Debug)]
pub struct Fdcan {
    registers: Registers,
    place: Place,
    ram: Vec<u32>,
    /// Indices of elements that wait for the bus, the oldest first.
    waiting: VecDeque<usize>,
    next_element: usize,
    /// Frames of FIFO 0 by the index of their element.
    received: VecDeque<usize>,
    next_received: usize,
    frames: [Option<Frame>; DEPTH],
    has_lost: bool,
    node: CanNode,
}

impl Fdcan {
    /// FDCAN after a reset.
    pub fn new(place: Place) -> Self {
        Self {
            registers: Registers::new(&TABLE),
            place,
            // RM0440 44.3.3: the message RAM is not cleared by a reset.
            ram: vec![0xa5a5_a5a5; (RAM / 4) as usize],
            waiting: VecDeque::new(),
            next_element: 0,
            received: VecDeque::new(),
            next_received: 0,
            frames: [const { None }; DEPTH],
            has_lost: false,
            node: CanNode::default(),
        }
    }

    fn has_bus(&self, wires: &Wires) -> bool {
        wires.can.cable.unit == self.place.number
    }

    fn is_routed(&self, wires: &Wires) -> bool {
        wires.leads_by(wires.can.cable.send, self.place.send)
            && wires.leads_by(wires.can.cable.receive, self.place.receive)
    }

    fn takes_part(&self, wires: &Wires) -> bool {
        self.node.takes_part() && self.has_bus(wires) && self.is_routed(wires)
    }

    fn change_control(&mut self, value: u32, before: u32, wires: &mut Wires) {
        let fixed = bits(15, 2) & !bit(4) & !bit(3);
        if (value ^ before) & fixed != 0 && before & (INIT | CCE) != INIT | CCE {
            wires.violation("FDCAN_CCCR", "modes are changed while INIT and CCE are not both 1", "RM0440 44.3.2");
        }
        for (place, what, section) in [
            (13, "edge filtering EFBI, which may lose frames", "ES0430, FDCAN"),
            (6, "no retransmission DAR, which loses frames on lost arbitration", "ES0430, FDCAN"),
            (5, "bus monitoring", "modes that the model does not have"),
            (2, "restricted operation", "modes that the model does not have"),
            (7, "test mode", "modes that the model does not have"),
        ] {
            if value >> place & 1 == 1 {
                wires.violation("FDCAN_CCCR", what, section);
            }
        }
        if value & INIT != 0 {
            self.node.leave();
        } else {
            self.registers.change(CCCR, 0, CCE);
            if before & INIT != 0 {
                self.check_timing(wires);
                self.check_pins(wires);
                self.node.join(wires);
            }
        }
    }

    /// Clock of the bit timing [Hz]; 0 if it is not that of the bus, whose rate the model knows.
    fn clock(&self, wires: &mut Wires) -> u64 {
        let (register, place) = self.place.selection;
        if wires.gates.get(&register).is_none_or(|value| value >> place & 3 != 2) {
            wires.violation("RCC_CCIPR", "FDCANSEL does not select the clock of the bus", "RM0440 7.4.27");
            return 0;
        }
        let divider = u64::from(self.registers.get(0x100));
        wires.clocks.low / if divider == 0 { 1 } else { 2 * divider }
    }

    /// Both bit timings against clock and bus (RM0440 44.4.3, 44.4.7).
    fn check_timing(&mut self, wires: &mut Wires) {
        let clock = self.clock(wires);
        let field = |register, low, count| u64::from(self.registers.field(register, low, count)) + 1;
        let timing = |prescaler: u64, before: u64, after: u64| {
            (clock / (prescaler * (1 + before + after)), 1000 * (1 + before) / (1 + before + after))
        };
        let (rate, point) = timing(field(NBTP, 16, 9), field(NBTP, 8, 8), field(NBTP, 0, 7));
        let jump = field(NBTP, 25, 7);
        let after = field(NBTP, 0, 7);
        let data = timing(field(DBTP, 16, 5), field(DBTP, 8, 5), field(DBTP, 4, 4));
        let data_prescaler = field(DBTP, 16, 5);
        let cable = wires.can.cable;
        let mut faults: Vec<(&str, String)> = Vec::new();
        faults.extend(CanNode::check_rate(rate, cable.bitrate, point).map(|what| ("FDCAN_NBTP", what)));
        if jump > after {
            faults.push(("FDCAN_NBTP", "the jump width exceeds the second segment".into()));
        }
        let is_flexible = self.registers.get(CCCR) & bit(8) != 0;
        if let Some(data_rate) = cable.data_bitrate {
            if !is_flexible {
                faults.push(("FDCAN_CCCR", "FDOE is 0 on a bus with CAN FD".into()));
            }
            faults.extend(CanNode::check_rate(data.0, data_rate, data.1).map(|what| ("FDCAN_DBTP", what)));
            let compensates = self.registers.is_set(DBTP, 23);
            if data_rate > 1_000_000 && !(compensates && data_prescaler <= 2) {
                let what = "no transceiver delay compensation, or a prescaler above 2 with it";
                faults.push(("FDCAN_DBTP", what.into()));
            }
            if compensates && self.registers.field(TDCR, 8, 7) == 0 {
                faults.push(("FDCAN_TDCR", "the offset of the second sample point is 0".into()));
            }
        }
        self.node.is_on_rate = faults.is_empty();
        let has_bus = self.has_bus(wires);
        for (register, what) in faults.into_iter().filter(|_| has_bus) {
            wires.violation(register, what, "RM0440 44.3.1, 44.4.3, 44.4.7");
        }
    }

    fn check_pins(&self, wires: &mut Wires) {
        if self.has_bus(wires) && !self.is_routed(wires) {
            let what = format!("INIT becomes 0 while a pin is not routed to FDCAN{}", self.place.number);
            wires.violation("FDCAN_CCCR", what, "RM0440 9.3.2");
        }
    }

    /// Takes the frames whose sending the core requests.
    fn request(&mut self, value: u32, wires: &mut Wires) {
        if self.registers.get(CCCR) & CCE != 0 {
            wires.violation("FDCAN_TXBAR", "is written while CCE is 1", "RM0440 44.4.35");
        }
        for index in (0..DEPTH).filter(|index| value >> index & 1 == 1) {
            if self.waiting.contains(&index) || index != self.next_element {
                let what = format!("element {index} is requested, and the next one is {}", self.next_element);
                wires.violation("FDCAN_TXBAR", what, "RM0440 44.3.6: transmit FIFO");
                continue;
            }
            self.next_element = (index + 1) % DEPTH;
            self.waiting.push_back(index);
            if let Some(frame) = self.element(SEND_FIFO + ELEMENT * index as u32, wires) {
                wires.can.handed.push((wires.can.ticks, frame));
            }
        }
    }

    /// Frame of an element in the message RAM.
    fn element(&self, offset: u32, wires: &mut Wires) -> Option<Frame> {
        let word = |place: u32| self.ram[((offset + 4 * place) / 4) as usize];
        let (id, control) = (word(0), word(1));
        let of = if id & bit(30) != 0 { extended(id) } else { standard((id >> 18) as u16) };
        let (is_flexible, is_fast) = (control & bit(21) != 0, control & bit(20) != 0);
        if control & bit(23) != 0 {
            wires.violation("message RAM", "a transmit event is requested", "modes that the model does not have");
        }
        if is_flexible && self.registers.get(CCCR) & bit(8) == 0 || is_fast && self.registers.get(CCCR) & bit(9) == 0 {
            wires.violation("message RAM", "a frame of CAN FD while FDOE or BRSE is 0", "RM0440 44.4.6");
        }
        let code = (control >> 16 & 0xf) as usize;
        let length = if is_flexible { LENGTHS[code] } else { LENGTHS[code].min(8) };
        let data: Vec<u8> = (0..16).flat_map(|place| word(2 + place).to_le_bytes()).take(length).collect();
        if id & bit(29) != 0 {
            return Frame::remote(of, length as u8);
        }
        Frame::with_kind(of, if is_flexible { Kind::Flexible(is_fast) } else { Kind::Classic }, &data)
    }

    /// Receives a frame of the other node.
    fn arrive(&mut self, frame: &Frame, wires: &mut Wires) {
        self.node.received();
        let settings = self.registers.get(RXGFC);
        let is_long = frame.extended_id().is_some();
        let (reject, fate) =
            if is_long { (settings & 1, settings >> 2 & 3) } else { (settings >> 1 & 1, settings >> 4 & 3) };
        let is_rejected = frame.kind == Kind::Remote && reject != 0;
        if settings & 0x0f1f_0000 != 0 || fate == 1 {
            wires.violation(
                "FDCAN_RXGFC",
                "filters of the message RAM, or FIFO 1",
                "modes that the model does not have",
            );
        }
        if is_rejected || fate != 0 {
            return;
        }
        if self.received.len() == DEPTH {
            (self.has_lost, wires.can.overruns) = (true, wires.can.overruns + 1);
            self.registers.change(IR, bit(2), 0);
            return;
        }
        let index = self.next_received;
        self.next_received = (index + 1) % DEPTH;
        self.received.push_back(index);
        self.frames[index] = Some(frame.clone());
        let at = ((FIFO_0 + ELEMENT * index as u32) / 4) as usize;
        let (id, control) = header(frame);
        (self.ram[at], self.ram[at + 1]) = (id, control);
        for (place, bytes) in frame.data().chunks(4).enumerate() {
            let mut word = [0; 4];
            word[..bytes.len()].copy_from_slice(bytes);
            self.ram[at + 2 + place] = u32::from_le_bytes(word);
        }
        self.registers.change(IR, bit(0) | u32::from(self.received.len() == DEPTH) << 1, 0);
    }

    fn acknowledge(&mut self, index: usize, wires: &mut Wires) {
        if !self.received.contains(&index) {
            wires.violation(
                "FDCAN_RXF0A",
                format!("element {index} is acknowledged, and is not filled"),
                "RM0440 44.4.22",
            );
            return;
        }
        // All elements up to this one are released.
        while let Some(front) = self.received.pop_front() {
            wires.can.taken.extend(self.frames[front].take().map(|frame| (wires.can.ticks, frame)));
            if front == index {
                break;
            }
        }
    }

    fn end_sending(&mut self, frame: Frame, is_destroyed: bool, wires: &mut Wires) {
        if !is_destroyed && wires.can.acknowledges {
            self.node.sent();
            self.waiting.pop_front();
            wires.can.to_others.push(frame);
        } else if self.node.failed(is_destroyed, wires) {
            // RM0440 44.3.1: INIT is set by bus-off; the recovery begins when the core clears it.
            self.registers.change(CCCR, INIT, 0);
            self.registers.change(IR, bit(19), 0);
            self.node.leave();
        }
    }

    fn advance_bus(&mut self, wires: &mut Wires) {
        self.node.pass_time(wires);
        if !self.has_bus(wires) {
            return;
        }
        loop {
            if let Some(transfer) = wires.can.ended(wires.now) {
                match transfer.sender {
                    Node::Board(_) => self.end_sending(transfer.frame, transfer.is_destroyed, wires),
                    Node::Other => {
                        let takes_part = self.takes_part(wires);
                        if takes_part {
                            self.arrive(&transfer.frame, wires);
                        }
                        wires.can.end_reception(takes_part);
                    }
                }
            }
            let index = self.waiting.front().copied().filter(|_| self.takes_part(wires));
            let frame = index.and_then(|index| self.element(SEND_FIFO + ELEMENT * index as u32, wires));
            let now = wires.now;
            let own = index.zip(frame.as_ref());
            if !wires.can.begin(own, now) || wires.can.next_event().is_none_or(|end| end > now) {
                return;
            }
        }
    }

    fn update_wires(&mut self, wires: &mut Wires) {
        let pending = self.registers.get(IR) & self.registers.get(IE);
        let is_on = self.registers.get(ILE) & 1 != 0 && self.registers.get(ILS) == 0;
        wires.interrupt(self.place.interrupt, is_on && pending != 0);
    }

    fn is_in_ram(&self, address: u32) -> bool {
        (self.place.ram..self.place.ram + RAM).contains(&address)
    }

    /// Checks an access to the message RAM; returns the index of the word.
    fn ram_word(&self, address: u32, size: u32, wires: &mut Wires) -> Option<usize> {
        if !wires.is_on(self.place.clock) {
            wires.violation("message RAM", "is accessed while the clock of FDCAN is off", "RM0440 7.4.17");
            return None;
        }
        if size != 4 || !address.is_multiple_of(4) {
            wires.violation("message RAM", format!("is accessed by {size} bytes"), "RM0440 44.3.3: words only");
            return None;
        }
        Some(((address - self.place.ram) / 4) as usize)
    }
}

impl Peripheral for Fdcan {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        match offset {
            RXF0S => {
                let front = self.received.front().copied().unwrap_or(self.next_received) as u32;
                self.received.len() as u32
                    | front << 8
                    | (self.next_received as u32) << 16
                    | u32::from(self.received.len() == DEPTH) << 24
                    | u32::from(self.has_lost) << 25
            }
            TXFQS => {
                let free = (DEPTH - self.waiting.len()) as u32;
                let first = self.waiting.front().copied().unwrap_or(self.next_element) as u32;
                free | first << 8 | (self.next_element as u32) << 16 | u32::from(free == 0) << 21
            }
            TXBRP => self.waiting.iter().map(|index| 1 << index).sum(),
            ECR => {
                let [sent, received] = self.node.errors.map(|count| count.min(OFF));
                sent | received.min(127) << 8
            }
            PSR => {
                if self.has_bus(wires) {
                    wires.can.note_seen_off(self.node.is_off);
                }
                let most = self.node.errors.into_iter().max().unwrap_or_default();
                let passive = u32::from(most >= PASSIVE) << 5 | u32::from(most >= WARNING) << 6;
                0x700 | self.node.last_error | passive | u32::from(self.node.is_off) << 7
            }
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        self.advance(wires);
        match offset {
            CCCR => self.change_control(value, before, wires),
            NBTP | DBTP | TDCR | RXGFC | 0xc0 | 0x100
                if self.registers.get(CCCR) & (INIT | CCE) != INIT | CCE && value != before =>
            {
                let what = format!("register {offset:#x} is changed while INIT and CCE are not both 1");
                wires.violation("FDCAN", what, "RM0440 44.3.2");
            }
            IR => {
                self.registers.change(IR, 0, value);
                self.has_lost &= value & bit(2) == 0;
            }
            RXF0A => self.acknowledge((value & 7) as usize, wires),
            TXBAR => self.request(value, wires),
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        self.advance_bus(wires);
        self.update_wires(wires);
    }

    fn next_event(&self) -> Option<Time> {
        self.node.next_event()
    }

    fn reset(&mut self) {
        let ram = std::mem::take(&mut self.ram);
        *self = Self { ram, ..Self::new(self.place) };
    }

    fn read_memory(&mut self, address: u32, size: u32, wires: &mut Wires) -> Option<u64> {
        self.is_in_ram(address).then(|| self.ram_word(address, size, wires).map_or(0, |word| self.ram[word].into()))
    }

    fn write_memory(&mut self, address: u32, size: u32, value: u64, wires: &mut Wires) -> bool {
        if !self.is_in_ram(address) {
            return false;
        }
        let offset = address - self.place.ram;
        let element = (offset.wrapping_sub(SEND_FIFO) / ELEMENT) as usize;
        if offset >= SEND_FIFO && self.waiting.contains(&element) {
            wires.violation("message RAM", "an element that waits for the bus is written", "RM0440 44.3.6");
        }
        if let Some(word) = self.ram_word(address, size, wires) {
            self.ram[word] = value as u32;
        }
        true
    }
}

/// Header words of an element.
fn header(frame: &Frame) -> (u32, u32) {
    let remote = u32::from(frame.kind == Kind::Remote) << 29;
    let id = match frame.id {
        Id::Standard(id) => u32::from(id.as_raw()) << 18,
        Id::Extended(id) => id.as_raw() | bit(30),
    };
    let kind = match frame.kind {
        Kind::Flexible(fast) => bit(21) | u32::from(fast) << 20,
        _ => 0,
    };
    let code = LENGTHS.iter().position(|length| *length >= frame.length()).unwrap_or_default();
    // ANMF: no filter has passed the frame.
    (id | remote, bit(31) | kind | (code as u32) << 16)
}

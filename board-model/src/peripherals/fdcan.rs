//! FDCAN of STM32G474 (RM0440 44) and STM32H743 (RM0433 56). Transmit FIFO, receive FIFO 0, message RAM, errors, bus-off,
//! second bit rate. Filters of the message RAM, FIFO 1, the transmit event FIFO, restricted operation and monitoring are
//! not modelled: setting them up is a violation, and so is what the errata forbid (ES0430, ES0392). Registers that differ
//! are in `fdcan_maps`.

use std::collections::VecDeque;

use drives::Frame;
use drives::frame::Kind;

use super::Peripheral;
use super::can_node::{CanNode, OFF, PASSIVE, WARNING};
use super::fdcan_maps::{CCCR, DBTP, ECR, GFC, IE, ILE, ILS, IR, Map, NBTP, PSR, TDCR};
use super::fdcan_ram::{Fifo, Parts, element_of, frame_of};
use crate::can_bus::Node;
use crate::register::{Registers, bit, bits};
use crate::wires::{Gate, Pin, Time, Wires};

const INIT: u32 = bit(0);
const CCE: u32 = bit(1);
/// Most elements of a FIFO.
const MOST: usize = 64;

/// Places of subjects in the list of the manual's sections.
const SETUP: usize = 0;
const TIMING: usize = 1;
const RAM: usize = 2;
const FIFO: usize = 3;

/// Connections of an FDCAN on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Number of the peripheral.
    pub number: u32,
    /// Registers of the chip.
    pub map: &'static Map,
    /// First address of its message RAM.
    pub ram: u32,
    /// Interrupt of line 0.
    pub interrupt: usize,
    /// Clock gate of peripheral and message RAM.
    pub clock: Gate,
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
    parts: Parts,
    /// Indices of elements that wait for the bus, the oldest first.
    waiting: VecDeque<usize>,
    next_element: usize,
    /// Frames of FIFO 0 by the index of their element.
    received: VecDeque<usize>,
    next_received: usize,
    frames: Vec<Option<Frame>>,
    has_lost: bool,
    node: CanNode,
}

impl Fdcan {
    /// FDCAN after a reset.
    pub fn new(place: Place) -> Self {
        let registers = Registers::new(place.map.table);
        Self {
            parts: (place.map.parts)(&registers),
            registers,
            place,
            // RM0440 44.3.3: the message RAM is not cleared by a reset.
            ram: vec![0xa5a5_a5a5; (place.map.ram / 4) as usize],
            waiting: VecDeque::new(),
            next_element: 0,
            received: VecDeque::new(),
            next_received: 0,
            frames: vec![None; MOST],
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
            wires.violation("FDCAN_CCCR", "modes are changed while INIT and CCE are not both 1", self.section(SETUP));
        }
        for (place, what, section) in [
            (13, "edge filtering EFBI, which may lose frames", "ES0430, ES0392, FDCAN"),
            (6, "no retransmission DAR, which loses frames on lost arbitration", "ES0430, ES0392, FDCAN"),
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
                self.check_ram(wires);
                self.node.join(wires);
            }
        }
    }

    /// Clock of the bit timing [Hz]; 0 if there is none. The bus of the registers must not be slower.
    fn clock(&self, wires: &mut Wires) -> u64 {
        let own = self.place.map.divider.map(|register| u64::from(self.registers.get(register)));
        let divider = own.map_or(wires.fdcan.divider, |own| Some(if own == 0 { 1 } else { 2 * own }));
        let clock = divider.map_or(0, |divider| wires.fdcan.selected / divider);
        if divider.is_none() {
            let what = "INIT becomes 0 while the clock calibration is not bypassed, which the model does not have";
            wires.violation("FDCAN_CCU_CCFG", what, self.section(TIMING));
        } else if clock == 0 {
            wires.violation("RCC", "FDCANSEL selects a clock that does not run", self.section(TIMING));
        } else if clock > wires.clocks.low {
            wires.violation("RCC", "FDCANSEL selects a clock above that of the bus", self.section(TIMING));
        }
        clock
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
            wires.violation(register, what, self.section(TIMING));
        }
    }

    /// Division of the message RAM, and settings that are not modelled.
    fn check_ram(&self, wires: &mut Wires) {
        for what in self.parts.faults(self.place.map.ram) {
            wires.violation("message RAM", what, self.section(RAM));
        }
        for missing in self.place.map.missing {
            if self.registers.get(missing.register) & missing.mask != 0 {
                wires.violation("FDCAN", missing.what, missing.section);
            }
        }
    }

    fn section(&self, subject: usize) -> &'static str {
        self.place.map.sections[subject]
    }

    fn check_pins(&self, wires: &mut Wires) {
        if self.has_bus(wires) && !self.is_routed(wires) {
            let what = format!("INIT becomes 0 while a pin is not routed to FDCAN{}", self.place.number);
            wires.violation("FDCAN_CCCR", what, "the table of alternate functions");
        }
    }

    /// Takes the frames whose sending the core requests.
    fn request(&mut self, value: u32, wires: &mut Wires) {
        if self.registers.get(CCCR) & CCE != 0 {
            wires.violation("FDCAN_TXBAR", "is written while CCE is 1", self.section(FIFO));
        }
        for index in (0..32).filter(|index| value >> index & 1 == 1) {
            if self.waiting.len() == self.parts.send.depth || index != self.next_element {
                let what = format!("element {index} is requested, and the next one is {}", self.next_element);
                wires.violation("FDCAN_TXBAR", what, self.section(FIFO));
                continue;
            }
            self.next_element = (index + 1) % self.parts.send.depth;
            self.waiting.push_back(index);
            if let Some(frame) = self.element(index, wires) {
                wires.can.handed.push((wires.can.ticks, frame));
            }
        }
    }

    /// Frame of an element of the transmit FIFO.
    fn element(&self, index: usize, wires: &mut Wires) -> Option<Frame> {
        let words = self.ram.get(words_of(self.parts.send, index)).unwrap_or_default();
        let frame = frame_of(words, self.parts.send.element as usize - 8);
        let modes = self.registers.get(CCCR);
        if words.get(1).is_some_and(|control| control & bit(23) != 0) {
            wires.violation("message RAM", "a transmit event is requested", "modes that the model does not have");
        }
        if let Some(Kind::Flexible(is_fast)) = frame.as_ref().map(|frame| frame.kind)
            && (modes & bit(8) == 0 || is_fast && modes & bit(9) == 0)
        {
            wires.violation("message RAM", "a frame of CAN FD while FDOE or BRSE is 0", self.section(SETUP));
        }
        frame
    }

    /// Receives a frame of the other node.
    fn arrive(&mut self, frame: &Frame, wires: &mut Wires) {
        self.node.received();
        let settings = self.registers.get(GFC);
        let is_long = frame.extended_id().is_some();
        let (reject, fate) =
            if is_long { (settings & 1, settings >> 2 & 3) } else { (settings >> 1 & 1, settings >> 4 & 3) };
        let is_rejected = frame.kind == Kind::Remote && reject != 0;
        if fate == 1 {
            wires.violation("FDCAN_GFC", "FIFO 1", "modes that the model does not have");
        }
        if is_rejected || fate != 0 {
            return;
        }
        let [full, lost, _] = self.place.map.flags;
        let fifo = self.parts.receive;
        if self.received.len() == fifo.depth {
            (self.has_lost, wires.can.overruns) = (true, wires.can.overruns + 1);
            self.registers.change(IR, bit(lost), 0);
            return;
        }
        let index = self.next_received;
        self.next_received = (index + 1) % fifo.depth;
        self.received.push_back(index);
        self.frames[index] = Some(frame.clone());
        if let Some(words) = self.ram.get_mut(words_of(fifo, index)) {
            let element = element_of(frame, fifo.element as usize - 8);
            words[..element.len()].copy_from_slice(&element);
        }
        self.registers.change(IR, bit(0) | u32::from(self.received.len() == fifo.depth) << full, 0);
    }

    fn acknowledge(&mut self, index: usize, wires: &mut Wires) {
        if !self.received.contains(&index) {
            wires.violation(
                "FDCAN_RXF0A",
                format!("element {index} is acknowledged, and is not filled"),
                self.section(FIFO),
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
            self.registers.change(IR, bit(self.place.map.flags[2]), 0);
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
            let frame = index.and_then(|index| self.element(index, wires));
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
        (self.place.ram..self.place.ram + self.place.map.ram).contains(&address)
    }

    /// Checks an access to the message RAM; returns the index of the word.
    fn ram_word(&self, address: u32, size: u32, wires: &mut Wires) -> Option<usize> {
        if !wires.is_on(self.place.clock) {
            wires.violation("message RAM", "is accessed while the clock of FDCAN is off", self.section(RAM));
            return None;
        }
        if size != 4 || !address.is_multiple_of(4) {
            wires.violation("message RAM", format!("is accessed by {size} bytes"), self.section(RAM));
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
        let ([received, _], [free, pending, _]) = (self.place.map.receive, self.place.map.send);
        match offset {
            _ if offset == received => {
                let front = self.received.front().copied().unwrap_or(self.next_received) as u32;
                self.received.len() as u32
                    | front << 8
                    | (self.next_received as u32) << 16
                    | u32::from(self.received.len() == self.parts.receive.depth) << 24
                    | u32::from(self.has_lost) << 25
            }
            _ if offset == free => {
                let free = (self.parts.send.depth - self.waiting.len()) as u32;
                let first = self.waiting.front().copied().unwrap_or(self.next_element) as u32;
                free | first << 8 | (self.next_element as u32) << 16 | u32::from(free == 0) << 21
            }
            _ if offset == pending => self.waiting.iter().map(|index| 1 << index).sum(),
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
        let map = self.place.map;
        let is_open = self.registers.get(CCCR) & (INIT | CCE) == INIT | CCE;
        let is_setting = matches!(offset, NBTP | DBTP | TDCR) || map.settings.contains(&offset);
        if is_setting && !is_open && value != before {
            let what = format!("register {offset:#x} is changed while INIT and CCE are not both 1");
            wires.violation("FDCAN", what, self.section(SETUP));
        }
        match offset {
            CCCR => self.change_control(value, before, wires),
            IR => {
                self.registers.change(IR, 0, value);
                self.has_lost &= value & bit(map.flags[1]) == 0;
            }
            _ if offset == map.receive[1] => self.acknowledge((value & 0x3f) as usize, wires),
            _ if offset == map.send[2] => self.request(value, wires),
            _ if is_setting => self.parts = (map.parts)(&self.registers),
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        self.advance_bus(wires);
        if self.place.number == 1 {
            wires.fdcan.is_open = self.registers.get(CCCR) & (INIT | CCE) == INIT | CCE;
        }
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
        if self.parts.send.index(offset).is_some_and(|index| self.waiting.contains(&index)) {
            wires.violation("message RAM", "an element that waits for the bus is written", self.section(FIFO));
        }
        if let Some(word) = self.ram_word(address, size, wires) {
            self.ram[word] = value as u32;
        }
        true
    }
}

/// Words of an element in the message RAM.
fn words_of(fifo: Fifo, index: usize) -> std::ops::Range<usize> {
    let start = (fifo.place(index) / 4) as usize;
    start..start + (fifo.element / 4) as usize
}

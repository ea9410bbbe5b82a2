//! bxCAN: RM0090 32. Three mailboxes, two FIFOs of three frames, 28 filter banks, errors, bus-off. Silent and loop-back
//! mode and time-triggered communication are not modelled: setting them is a violation.

use std::collections::VecDeque;

use bus_wires::bits::priority;
use drives::Frame;
use drives::frame::{Id, Kind, extended, standard};

use super::Peripheral;
use super::can_node::{CanNode, OFF, PASSIVE, WARNING};
use crate::can_bus::Node;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Pin, Time, Wires};

const MCR: u32 = 0x00;
const MSR: u32 = 0x04;
const TSR: u32 = 0x08;
const RF0R: u32 = 0x0c;
const IER: u32 = 0x14;
const ESR: u32 = 0x18;
const BTR: u32 = 0x1c;
const TX: u32 = 0x180;
const RX: u32 = 0x1b0;
const FMR: u32 = 0x200;
const FM1R: u32 = 0x204;
const FS1R: u32 = 0x20c;
const FFA1R: u32 = 0x214;
const FA1R: u32 = 0x21c;
const BANKS: u32 = 0x240;

const INRQ: u32 = bit(0);
const SLEEP: u32 = bit(1);
const TXFP: u32 = bit(2);
const ABOM: u32 = bit(6);

/// Depth of a FIFO.
const DEPTH: usize = 3;
macro_rules! bank {
    ($first:literal, $second:literal, $offset:literal) => {
        [Register::new($first, BANKS + $offset, 0, u32::MAX), Register::new($second, BANKS + $offset + 4, 0, u32::MAX)]
    };
}

/// Only the banks 0 and 14 are described: a filter in another one is reported as unknown.
static TABLE: [Register; 34] = {
    let [bank_0, bank_0_mask] = bank!("CAN_F0R1", "CAN_F0R2", 0);
    let [bank_14, bank_14_mask] = bank!("CAN_F14R1", "CAN_F14R2", 112);
    [
        Register::new("CAN_MCR", MCR, 0x0001_0002, 0x0001_80ff).special(bit(15)),
        Register::new("CAN_MSR", MSR, 0x0000_0c02, 0x0f1f).special(0x0f1f),
        Register::new("CAN_TSR", TSR, 0x1c00_0000, 0xff8f_8f8f).special(0xff8f_8f8f),
        Register::new("CAN_RF0R", RF0R, 0, 0x3b).special(0x3b),
        Register::new("CAN_RF1R", 0x10, 0, 0x3b).special(0x3b),
        Register::new("CAN_IER", IER, 0, 0x0003_8f7f),
        Register::new("CAN_ESR", ESR, 0, 0xffff_0077).special(0xffff_0007),
        Register::new("CAN_BTR", BTR, 0x0123_0000, 0xc37f_03ff),
        Register::new("CAN_TI0R", TX, 0, u32::MAX),
        Register::new("CAN_TDT0R", TX + 4, 0, 0xffff_010f),
        Register::new("CAN_TDL0R", TX + 8, 0, u32::MAX),
        Register::new("CAN_TDH0R", TX + 12, 0, u32::MAX),
        Register::new("CAN_TI1R", TX + 16, 0, u32::MAX),
        Register::new("CAN_TDT1R", TX + 20, 0, 0xffff_010f),
        Register::new("CAN_TDL1R", TX + 24, 0, u32::MAX),
        Register::new("CAN_TDH1R", TX + 28, 0, u32::MAX),
        Register::new("CAN_TI2R", TX + 32, 0, u32::MAX),
        Register::new("CAN_TDT2R", TX + 36, 0, 0xffff_010f),
        Register::new("CAN_TDL2R", TX + 40, 0, u32::MAX),
        Register::new("CAN_TDH2R", TX + 44, 0, u32::MAX),
        Register::new("CAN_RI0R", RX, 0, u32::MAX).special(u32::MAX),
        Register::new("CAN_RDT0R", RX + 4, 0, u32::MAX).special(u32::MAX),
        Register::new("CAN_RDL0R", RX + 8, 0, u32::MAX).special(u32::MAX),
        Register::new("CAN_RDH0R", RX + 12, 0, u32::MAX).special(u32::MAX),
        Register::new("CAN_FMR", FMR, 0x2a1c_0e01, 0x3f01),
        Register::new("CAN_FM1R", FM1R, 0, 0x0fff_ffff),
        Register::new("CAN_FS1R", FS1R, 0, 0x0fff_ffff),
        Register::new("CAN_FFA1R", FFA1R, 0, 0x0fff_ffff),
        Register::new("CAN_FA1R", FA1R, 0, 0x0fff_ffff),
        bank_0,
        bank_0_mask,
        bank_14,
        bank_14_mask,
        Register::new("CAN_RF1 mailbox", RX + 16, 0, u32::MAX).special(u32::MAX),
    ]
};

/// Connections of a bxCAN on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Number of the peripheral.
    pub number: u32,
    /// Interrupts: transmit, FIFO 0, FIFO 1, changes and errors.
    pub interrupts: [usize; 4],
    /// Possible transmit pins, with the alternate function.
    pub send: &'static [(Pin, u32)],
    /// Possible receive pins.
    pub receive: &'static [(Pin, u32)],
}

/// State of a mailbox.
#[derive(Debug, Clone, Default)]
struct Mailbox {
    /// Frame that waits or is being sent, and the number of its request.
    pending: Option<(u64, Frame)>,
    /// RQCP, TXOK, ALST, TERR.
    flags: u32,
}

/// bxCAN.
#[derive(Debug)]
pub struct Bxcan {
    registers: Registers,
    place: Place,
    mailboxes: [Mailbox; 3],
    requests: u64,
    fifo: VecDeque<Frame>,
    overran: bool,
    node: CanNode,
}

impl Bxcan {
    /// bxCAN after a reset.
    pub fn new(place: Place) -> Self {
        Self {
            registers: Registers::new(&TABLE),
            place,
            mailboxes: Default::default(),
            requests: 0,
            fifo: VecDeque::new(),
            overran: false,
            node: CanNode::default(),
        }
    }

    fn has_bus(&self, wires: &Wires) -> bool {
        wires.can.cable.unit == self.place.number
    }

    fn control(&self) -> u32 {
        self.registers.get(MCR)
    }

    fn is_in_initialisation(&self) -> bool {
        self.control() & INRQ != 0 && self.control() & SLEEP == 0
    }

    /// Handles a change of the mode (RM0090 32.4).
    fn change_mode(&mut self, before: u32, wires: &mut Wires) {
        let was = before & INRQ != 0 && before & SLEEP == 0;
        let is = self.is_in_initialisation();
        if is && !was {
            // After a transfer under way; here at once.
            self.node.leave();
        }
        if was && !is && self.control() & SLEEP == 0 {
            self.check_timing(wires);
            self.check_pins(wires);
            self.node.join(wires);
        }
        let unsupported = self.control() & (bit(7) | bit(4) | bit(5) | bit(3));
        if unsupported != 0 {
            let what = format!("modes {unsupported:#x}: time-triggered, no retransmission, wake-up or locked FIFO");
            wires.violation("CAN_MCR", what, "modes that the model does not have");
        }
    }

    /// Bit timing against the clock and the bus (RM0090 32.7.7).
    fn check_timing(&mut self, wires: &mut Wires) {
        let field = |low, count| u64::from(self.registers.field(BTR, low, count)) + 1;
        let (prescaler, before, after, jump) = (field(0, 10), field(16, 4), field(20, 3), field(24, 2));
        let quanta = 1 + before + after;
        let rate = wires.clocks.low / (prescaler * quanta);
        let fault = CanNode::check_rate(rate, wires.can.cable.bitrate, 1000 * (1 + before) / quanta);
        self.node.is_on_rate = fault.is_none();
        if let Some(what) = fault.filter(|_| self.has_bus(wires)) {
            wires.violation("CAN_BTR", what, "RM0090 32.7.7");
        }
        if jump > after {
            wires.violation("CAN_BTR", "the jump width exceeds the second segment", "RM0090 32.7.7");
        }
        if self.registers.get(BTR) & bits(31, 30) != 0 {
            wires.violation("CAN_BTR", "silent or loop-back mode", "modes that the model does not have");
        }
    }

    fn check_pins(&self, wires: &mut Wires) {
        if !self.has_bus(wires) {
            return;
        }
        let ends = [
            (wires.can.cable.send, self.place.send, "sends"),
            (wires.can.cable.receive, self.place.receive, "receives"),
        ];
        for (pin, list, what) in ends {
            if !wires.leads_by(pin, list) {
                let what = format!(
                    "the initialisation ends while the pin that {what} is not routed to CAN{}",
                    self.place.number
                );
                wires.violation("CAN_MCR", what, "RM0090 8.3.2");
            }
        }
    }

    fn is_routed(&self, wires: &Wires) -> bool {
        wires.leads_by(wires.can.cable.send, self.place.send)
            && wires.leads_by(wires.can.cable.receive, self.place.receive)
    }

    /// True while the peripheral takes part in the bus.
    fn takes_part(&self, wires: &Wires) -> bool {
        self.node.takes_part() && self.has_bus(wires) && self.is_routed(wires)
    }

    /// Mailbox that is sent next (RM0090 32.7.1): by request, or by identifier and number.
    fn next_mailbox(&self) -> Option<usize> {
        let by_request = self.control() & TXFP != 0;
        let waiting = self.mailboxes.iter().enumerate().filter_map(|(place, mailbox)| {
            let (request, frame) = mailbox.pending.as_ref()?;
            Some((place, if by_request { *request } else { priority(frame).into() }))
        });
        waiting.min_by_key(|(place, order)| (*order, *place)).map(|(place, _)| place)
    }

    /// Takes a frame that the core requests to send.
    fn request(&mut self, place: usize, wires: &mut Wires) {
        let base = TX + 16 * place as u32;
        let (id, length) = (self.registers.get(base), self.registers.field(base + 4, 0, 4) as usize);
        let data = [8, 12].map(|offset| self.registers.get(base + offset).to_le_bytes());
        if length > 8 {
            wires.violation("CAN_TDTxR", format!("a length of {length} bytes"), "RM0090 32.9.3");
        }
        if self.is_in_initialisation() {
            wires.violation("CAN_TIxR", "a frame is requested while the peripheral is initialised", "RM0090 32.7.1");
        }
        let Some(frame) = frame(id, &data.as_flattened()[..length.min(8)]) else { return };
        wires.can.handed.push((wires.can.ticks, frame.clone()));
        self.requests += 1;
        self.mailboxes[place] = Mailbox { pending: Some((self.requests, frame)), flags: 0 };
    }

    /// Returns whether a filter for FIFO 0 passes a frame. Masks of 32 bits alone are modelled.
    fn passes(&self, frame: &Frame) -> bool {
        let bank = if self.place.number == 2 { 14 } else { 0 };
        let is_set = |register| self.registers.is_set(register, bank);
        let is_mask_of_32_bits = !is_set(FM1R) && is_set(FS1R);
        if self.registers.is_set(FMR, 0) || !is_set(FA1R) || is_set(FFA1R) || !is_mask_of_32_bits {
            return false;
        }
        let [wanted, mask] = [0, 4].map(|offset| self.registers.get(BANKS + 8 * bank + offset));
        (identifier(frame) ^ wanted) & mask == 0
    }

    /// Receives a frame of the other node.
    fn arrive(&mut self, frame: &Frame, wires: &mut Wires) {
        self.node.received();
        if !self.passes(frame) {
            return;
        }
        if self.fifo.len() == DEPTH {
            // The last frame is overwritten (RM0090 32.7.3).
            self.fifo.pop_back();
            self.overran = true;
            wires.can.overruns += 1;
        }
        self.fifo.push_back(frame.clone());
    }

    /// Ends the sending of a mailbox.
    fn end_sending(&mut self, place: usize, is_destroyed: bool, wires: &mut Wires) {
        if !is_destroyed && wires.can.acknowledges {
            self.node.sent();
            self.mailboxes[place].flags = 0b11;
            wires.can.to_others.extend(self.mailboxes[place].pending.take().map(|(_, frame)| frame));
            return;
        }
        self.mailboxes[place].flags = 0b1000;
        if self.node.failed(is_destroyed, wires) && self.control() & ABOM != 0 {
            self.node.recover(wires);
        }
    }

    /// Moves the bus forward.
    fn advance_bus(&mut self, wires: &mut Wires) {
        self.node.pass_time(wires);
        if !self.has_bus(wires) {
            return;
        }
        loop {
            if let Some(transfer) = wires.can.ended(wires.now) {
                match transfer.sender {
                    Node::Board(place) => self.end_sending(place, transfer.is_destroyed, wires),
                    Node::Other => {
                        let takes_part = self.takes_part(wires);
                        if takes_part {
                            self.arrive(&transfer.frame, wires);
                        }
                        wires.can.end_reception(takes_part);
                    }
                }
            }
            let own = self.next_mailbox().filter(|_| self.takes_part(wires));
            let own = own.and_then(|place| Some((place, &self.mailboxes[place].pending.as_ref()?.1)));
            let now = wires.now;
            if !wires.can.begin(own, now) || wires.can.next_event().is_none_or(|end| end > now) {
                return;
            }
        }
    }

    fn status(&self) -> u32 {
        let mut status = 0;
        for (place, mailbox) in (0..).zip(&self.mailboxes) {
            status |= mailbox.flags << (8 * place) | u32::from(mailbox.pending.is_none()) << (26 + place);
        }
        let free = self.mailboxes.iter().position(|mailbox| mailbox.pending.is_none()).unwrap_or_default();
        status | (free as u32) << 24
    }

    fn fifo_status(&self) -> u32 {
        self.fifo.len() as u32 | u32::from(self.fifo.len() == DEPTH) << 3 | u32::from(self.overran) << 4
    }

    fn error_status(&self) -> u32 {
        let [sent, received] = self.node.errors.map(|count| count.min(OFF));
        let most = sent.max(received);
        received << 24
            | sent << 16
            | self.node.last_error << 4
            | u32::from(self.node.is_off) << 2
            | u32::from(most >= PASSIVE) << 1
            | u32::from(most >= WARNING)
    }

    fn receive_register(&self, offset: u32) -> u32 {
        let Some(frame) = self.fifo.front() else { return 0 };
        let mut data = [[0; 4]; 2];
        data.as_flattened_mut().iter_mut().zip(frame.data()).for_each(|(place, byte)| *place = *byte);
        match offset - RX {
            0 => identifier(frame),
            4 => frame.length() as u32,
            8 => u32::from_le_bytes(data[0]),
            _ => u32::from_le_bytes(data[1]),
        }
    }

    fn update_wires(&mut self, wires: &mut Wires) {
        let enabled = self.registers.get(IER);
        let [send, fifo, other, change] = self.place.interrupts;
        let done = self.mailboxes.iter().any(|mailbox| mailbox.flags & 1 != 0);
        wires.interrupt(send, enabled & bit(0) != 0 && done);
        let wanted = [(1, !self.fifo.is_empty()), (2, self.fifo.len() == DEPTH), (3, self.overran)];
        wires.interrupt(fifo, wanted.iter().any(|(place, level)| enabled >> place & 1 == 1 && *level));
        wires.interrupt(other, false);
        let off = enabled & bit(15) != 0 && enabled & bit(10) != 0 && self.node.is_off;
        wires.interrupt(change, off);
    }
}

impl Peripheral for Bxcan {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        match offset {
            // INAK and SLAK follow the mode; INAK falls once the peripheral has joined the bus.
            MSR => {
                let inak = self.is_in_initialisation() || self.node.joins_at.is_some();
                0x0c00 | u32::from(inak) | self.control() & SLEEP
            }
            TSR => self.status(),
            RF0R => self.fifo_status(),
            ESR => {
                if self.has_bus(wires) {
                    wires.can.note_seen_off(self.node.is_off);
                }
                self.error_status() | self.registers.get(ESR) & 0x70
            }
            RX..0x1c0 => {
                if self.fifo.is_empty() {
                    wires.violation("CAN_RI0R", "the mailbox of an empty FIFO is read", "RM0090 32.7.3");
                }
                self.receive_register(offset)
            }
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        self.advance(wires);
        match offset {
            MCR => self.change_mode(before, wires),
            BTR if !self.is_in_initialisation() => {
                wires.violation("CAN_BTR", "is written outside of initialisation", "RM0090 32.9.2");
            }
            TSR => {
                for (place, mailbox) in (0..).zip(&mut self.mailboxes) {
                    if value >> (8 * place) & 1 == 1 {
                        mailbox.flags = 0;
                    }
                    if value >> (8 * place + 7) & 1 == 1 {
                        mailbox.pending = None;
                    }
                }
            }
            RF0R => {
                self.overran &= value & bit(4) == 0;
                if value & bit(5) != 0 {
                    match self.fifo.pop_front() {
                        Some(frame) => wires.can.taken.push((wires.can.ticks, frame)),
                        None => wires.violation("CAN_RF0R", "an empty FIFO is released", "RM0090 32.7.3"),
                    }
                }
            }
            TX..RX => {
                let place = ((offset - TX) / 16) as usize;
                if self.mailboxes[place].pending.is_some() {
                    wires.violation("CAN_TIxR", "a mailbox is written that is not empty", "RM0090 32.7.1");
                } else if (offset - TX).is_multiple_of(16) && value & 1 != 0 {
                    self.request(place, wires);
                }
            }
            FM1R | FS1R | FFA1R if !self.registers.is_set(FMR, 0) => {
                wires.violation("CAN_FMR", "filters are set up while FINIT is 0", "RM0090 32.9.4");
            }
            offset if offset >= BANKS => {
                let bank = (offset - BANKS) / 8;
                if self.registers.is_set(FA1R, bank) && !self.registers.is_set(FMR, 0) {
                    wires.violation("CAN_FiRx", "an active filter is changed", "RM0090 32.9.4");
                }
            }
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
        *self = Self::new(self.place);
    }
}

/// Register of an identifier.
fn identifier(frame: &Frame) -> u32 {
    let remote = u32::from(frame.kind == Kind::Remote) << 1;
    match frame.id {
        Id::Standard(id) => u32::from(id.as_raw()) << 21 | remote,
        Id::Extended(id) => id.as_raw() << 3 | bit(2) | remote,
    }
}

/// Frame of a mailbox's registers.
fn frame(id: u32, data: &[u8]) -> Option<Frame> {
    let of = if id & bit(2) != 0 { extended(id >> 3) } else { standard((id >> 21) as u16) };
    match id & bit(1) != 0 {
        true => Frame::remote(of, data.len() as u8),
        false => Frame::classic(of, data),
    }
}

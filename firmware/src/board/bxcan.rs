//! bxCAN of STM32F4 (RM0090 32): classical CAN with three mailboxes, sent in the order of their requests, and FIFO 0 of
//! three frames, whose interrupt the board's role serves. All identifiers pass one filter, since clients may change that
//! of a drive at run time, and CANopen has broadcasts. The peripheral leaves bus-off by itself after 128 times 11
//! recessive bits, as the makers' drives do.

use drives::Frame;
use drives::frame::{Id, Kind, extended, standard};

use super::bounded_wait::wait_until;
use super::description::CAN_TIMING;
use super::pac;
use crate::can::{CanReceiver, CanSender};

#[cfg(can = "can1")]
type Unit = pac::CAN1;
#[cfg(can = "can2")]
type Unit = pac::CAN2;

/// Filter bank: CAN2 has those from 14 on, all of them in the registers of CAN1.
const BANK: usize = if cfg!(can = "can2") { 14 } else { 0 };
/// Identifier of 29 bits, and remote frame, in the identifier registers.
const EXTENDED: u32 = 1 << 2;
const REMOTE: u32 = 1 << 1;
/// Request to send, in a mailbox.
const SEND: u32 = 1;

/// Receiving half: FIFO 0.
pub struct Receiver(Unit);

/// Sending half: the mailboxes.
pub struct Sender(Unit);

/// Starts the peripheral; its pins are routed by the caller. The bus may be silent or held by another node: the
/// peripheral joins it after 11 recessive bits, without waiting here.
pub fn open(clocks: &pac::RCC) -> (Receiver, Sender) {
    clocks.apb1enr().modify(|_, w| w.can1en().set_bit().can2en().bit(BANK != 0));
    let _ = clocks.apb1enr().read();
    clocks.apb1rstr().modify(|_, w| w.can1rst().set_bit().can2rst().bit(BANK != 0));
    clocks.apb1rstr().modify(|_, w| w.can1rst().clear_bit().can2rst().clear_bit());
    // SAFETY: called once, at the start; the peripheral has no other user. Its halves write different registers.
    let (unit, receiving, filters) = unsafe { (Unit::steal(), Unit::steal(), pac::CAN1::steal()) };
    unit.mcr().modify(|_, w| w.sleep().clear_bit().inrq().set_bit());
    // A peripheral that does not answer is left alone: nothing is received and nothing sent.
    let _ = wait_until(|| unit.msr().read().inak().bit_is_set());
    unit.mcr().modify(|_, w| w.txfp().set_bit().abom().set_bit());
    let (prescaler, before, after, jump) = CAN_TIMING;
    let timing = (jump - 1) << 24 | (after - 1) << 20 | (before - 1) << 16 | (prescaler - 1);
    // SAFETY: the build has held the timing against the ranges of the reference manual.
    unit.btr().write(|w| unsafe { w.bits(timing) });
    accept_all(&filters);
    unit.ier().write(|w| w.fmpie0().set_bit());
    unit.mcr().modify(|_, w| w.inrq().clear_bit());
    (Receiver(receiving), Sender(unit))
}

/// Sets up one filter of 32 bits with an empty mask, for FIFO 0.
fn accept_all(filters: &pac::CAN1) {
    // SAFETY: bits of one bank, which exists; every mask is allowed.
    unsafe {
        filters.fmr().modify(|r, w| w.bits(r.bits() | 1));
        filters.fa1r().modify(|r, w| w.bits(r.bits() & !(1 << BANK)));
        filters.fm1r().modify(|r, w| w.bits(r.bits() & !(1 << BANK)));
        filters.fs1r().modify(|r, w| w.bits(r.bits() | 1 << BANK));
        filters.ffa1r().modify(|r, w| w.bits(r.bits() & !(1 << BANK)));
        filters.fb(BANK).fr1().write(|w| w.bits(0));
        filters.fb(BANK).fr2().write(|w| w.bits(0));
        filters.fa1r().modify(|r, w| w.bits(r.bits() | 1 << BANK));
        filters.fmr().modify(|r, w| w.bits(r.bits() & !1));
    }
}

impl CanReceiver for Receiver {
    /// Does nothing: the interrupt is requested as long as a frame is in the FIFO.
    fn acknowledge(&mut self) {}

    fn receive(&mut self) -> Option<Frame> {
        let status = self.0.rf0r().read();
        // While the release of the frame before is under way, its registers still hold that frame.
        if status.fmp().bits() == 0 || status.rfom().is_release() {
            return None;
        }
        let mailbox = self.0.rx(0);
        let (id, length) = (mailbox.rir().read().bits(), mailbox.rdtr().read().bits() & 0xf);
        let data = [mailbox.rdlr().read().bits(), mailbox.rdhr().read().bits()].map(u32::to_le_bytes);
        self.0.rf0r().write(|w| w.rfom().release());
        decode(id, length as usize, data)
    }
}

impl CanSender for Sender {
    fn send(&mut self, frame: &Frame) -> bool {
        let Some((id, length, data)) = encode(frame) else { return true };
        let status = self.0.tsr().read();
        let free = [status.tme0(), status.tme1(), status.tme2()].map(|empty| empty.bit_is_set());
        let Some(place) = free.iter().position(|free| *free) else { return false };
        let mailbox = self.0.tx(place);
        let [low, high] = data.map(u32::from_le_bytes);
        // SAFETY: every identifier, data and length below 9 is allowed.
        unsafe {
            mailbox.tdtr().write(|w| w.bits(length));
            mailbox.tdlr().write(|w| w.bits(low));
            mailbox.tdhr().write(|w| w.bits(high));
            mailbox.tir().write(|w| w.bits(id | SEND));
        }
        true
    }

    fn is_off(&mut self) -> bool {
        self.0.esr().read().boff().bit_is_set()
    }
}

/// Frame of a mailbox.
fn decode(id: u32, length: usize, data: [[u8; 4]; 2]) -> Option<Frame> {
    let length = length.min(8);
    let frame_id = if id & EXTENDED != 0 { extended(id >> 3) } else { standard((id >> 21) as u16) };
    if id & REMOTE != 0 {
        return Frame::remote(frame_id, length as u8);
    }
    Frame::classic(frame_id, data.as_flattened().get(..length)?)
}

/// Registers of a mailbox: identifier, length, data. `None` for a frame of CAN FD.
fn encode(frame: &Frame) -> Option<(u32, u32, [[u8; 4]; 2])> {
    let id = match frame.id {
        Id::Standard(id) => u32::from(id.as_raw()) << 21,
        Id::Extended(id) => id.as_raw() << 3 | EXTENDED,
    };
    let remote = match frame.kind {
        Kind::Classic => 0,
        Kind::Remote => REMOTE,
        Kind::Flexible(_) => return None,
    };
    let mut bytes = [[0; 4]; 2];
    let all = bytes.as_flattened_mut().iter_mut().zip(frame.data());
    all.for_each(|(place, byte)| *place = *byte);
    Some((id | remote, frame.length().min(8) as u32, bytes))
}

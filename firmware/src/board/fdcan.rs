//! FDCAN of STM32G4 (RM0440 44) and STM32H743 (RM0433 56): CAN FD with a transmit FIFO and receive FIFO 0 of three
//! frames each. Clock and message RAM differ: `fdcan_g4`, `fdcan_h7`. No filter is set up: all identifiers go to FIFO 0,
//! since clients may change that of a drive at run time, and CANopen has broadcasts. After bus-off the tick ends the
//! initialisation that the peripheral has begun, and the peripheral waits for 128 times 11 recessive bits, as the makers'
//! drives do.
//!
//! Errata (ES0430, ES0392): no edge filtering, no dedicated transmit buffers beside the FIFO, retransmission left on.

use drives::Frame;
use drives::frame::{Id, Kind, LENGTHS, MAX_DATA, extended, length_code, standard};

use super::bounded_wait::wait_until;
use super::description::{CAN_DATA_TIMING, CAN_TIMING};
#[cfg(family = "stm32g4")]
use super::fdcan_g4::{DEPTH, ELEMENT, FIFO_0, RAM, RAM_WORDS, SEND_FIFO, Unit, lay_out_ram, turn_on};
#[cfg(family = "stm32h7")]
use super::fdcan_h7::{DEPTH, ELEMENT, FIFO_0, RAM, RAM_WORDS, SEND_FIFO, Unit, lay_out_ram, turn_on};
use super::pac;
use crate::can::{CanReceiver, CanSender};

/// Bits of an element's first word.
const EXTENDED: u32 = 1 << 30;
const REMOTE: u32 = 1 << 29;
/// Bits of an element's second word.
const FLEXIBLE: u32 = 1 << 21;
const FAST: u32 = 1 << 20;
/// New frame in FIFO 0, in the interrupt flags.
const NEW: u32 = 1;
/// Initialisation, and access to the settings, in CCCR; FD frames and second bit rate.
const INIT: u32 = 1;
const CHANGE: u32 = 1 << 1;
const FLEXIBLE_FRAMES: u32 = 1 << 8 | 1 << 9;
/// Transceiver delay compensation, in DBTP.
const COMPENSATION: u32 = 1 << 23;

/// Receiving half: FIFO 0.
pub struct Receiver(Unit);

/// Sending half: the transmit FIFO, and the mode.
pub struct Sender(Unit);

/// Starts the peripheral. The bus may be silent or held by another node: the peripheral joins it after 11 recessive
/// bits, without waiting here.
pub fn open(clocks: &pac::RCC) -> (Receiver, Sender) {
    turn_on(clocks);
    // SAFETY: called once, at the start; the peripheral has no other user. Its halves write different registers.
    let (unit, receiving) = unsafe { (Unit::steal(), Unit::steal()) };
    for word in 0..RAM_WORDS {
        write_ram(4 * word, 0);
    }
    // SAFETY: defined bits; the build has held the timing against the ranges of the reference manual.
    unsafe {
        unit.cccr().write(|w| w.bits(INIT));
        // A peripheral that does not answer is left alone: nothing is received and nothing sent.
        let _ = wait_until(|| unit.cccr().read().bits() & INIT != 0);
        unit.cccr().write(|w| w.bits(INIT | CHANGE));
        let flexible = if CAN_DATA_TIMING.is_some() { FLEXIBLE_FRAMES } else { 0 };
        unit.cccr().write(|w| w.bits(INIT | CHANGE | flexible));
        lay_out_ram(&unit);
        let (prescaler, before, after, jump) = CAN_TIMING;
        unit.nbtp().write(|w| w.bits((jump - 1) << 25 | (prescaler - 1) << 16 | (before - 1) << 8 | (after - 1)));
        if let Some((prescaler, before, after, jump)) = CAN_DATA_TIMING {
            let timing = (prescaler - 1) << 16 | (before - 1) << 8 | (after - 1) << 4 | (jump - 1);
            unit.dbtp().write(|w| w.bits(COMPENSATION | timing));
            // Second sample point: as late after the delay as the sample point of a bit.
            unit.tdcr().write(|w| w.bits((prescaler * (1 + before)).min(127) << 8));
        }
        unit.ie().write(|w| w.bits(NEW));
        unit.ile().write(|w| w.bits(1));
        unit.cccr().write(|w| w.bits(flexible));
    }
    (Receiver(receiving), Sender(unit))
}

/// Writes a word of the message RAM, which has no other access.
fn write_ram(offset: usize, word: u32) {
    // SAFETY: callers stay within the message RAM of this peripheral, in elements that the peripheral does not use.
    unsafe { ((RAM + offset) as *mut u32).write_volatile(word) }
}

fn read_ram(offset: usize) -> u32 {
    // SAFETY: as for writing.
    unsafe { ((RAM + offset) as *const u32).read_volatile() }
}

/// Place of an element of a FIFO in the message RAM [byte]; indices of the peripheral are below the depth.
fn element(fifo: usize, index: u8) -> usize {
    fifo + ELEMENT * usize::from(index).min(DEPTH - 1)
}

impl CanReceiver for Receiver {
    /// Clears the flag of a new frame, once before the first look at the FIFO: cleared between two looks, the flag of a
    /// frame that the last look of a service does not reach would be lost.
    fn acknowledge(&mut self) {
        // SAFETY: ones clear flags.
        self.0.ir().write(|w| unsafe { w.bits(NEW) });
    }

    fn receive(&mut self) -> Option<Frame> {
        let status = self.0.rxf0s().read();
        if status.f0fl().bits() == 0 {
            return None;
        }
        let index = status.f0gi().bits();
        let element = element(FIFO_0, index);
        let (id, control) = (read_ram(element), read_ram(element + 4));
        let mut data = [[0; 4]; MAX_DATA / 4];
        let length = length_of(control);
        for (place, word) in data.iter_mut().enumerate().take(length.div_ceil(4)) {
            *word = read_ram(element + 8 + 4 * place).to_le_bytes();
        }
        // SAFETY: the index is that of the FIFO.
        self.0.rxf0a().write(|w| unsafe { w.bits(index.into()) });
        decode(id, control, data.as_flattened().get(..length)?)
    }
}

impl CanSender for Sender {
    fn send(&mut self, frame: &Frame) -> bool {
        if matches!(frame.kind, Kind::Flexible(_)) && CAN_DATA_TIMING.is_none() {
            return true;
        }
        let status = self.0.txfqs().read();
        if status.tffl().bits() == 0 {
            return false;
        }
        let index = status.tfqpi().bits();
        let element = element(SEND_FIFO, index);
        let (id, control) = encode(frame);
        write_ram(element, id);
        write_ram(element + 4, control);
        for (place, bytes) in frame.data().chunks(4).enumerate() {
            let mut word = [0; 4];
            word.iter_mut().zip(bytes).for_each(|(place, byte)| *place = *byte);
            write_ram(element + 8 + 4 * place, u32::from_le_bytes(word));
        }
        // SAFETY: a request for the element that was just written.
        self.0.txbar().write(|w| unsafe { w.bits(1 << index) });
        true
    }

    fn is_off(&mut self) -> bool {
        let is_off = self.0.psr().read().bo().bit_is_set();
        if is_off {
            // SAFETY: the other bits keep their values.
            self.0.cccr().modify(|r, w| unsafe { w.bits(r.bits() & !INIT) });
        }
        is_off
    }
}

/// Data bytes of an element by its second word; a classical frame has 8 at most.
fn length_of(control: u32) -> usize {
    let code = (control >> 16 & 0xf) as usize;
    let length = LENGTHS[code];
    if control & FLEXIBLE == 0 { length.min(8) } else { length }
}

/// Frame of an element.
fn decode(id: u32, control: u32, data: &[u8]) -> Option<Frame> {
    let of = if id & EXTENDED != 0 { extended(id) } else { standard((id >> 18) as u16) };
    if id & REMOTE != 0 {
        return Frame::remote(of, data.len() as u8);
    }
    let kind = if control & FLEXIBLE != 0 { Kind::Flexible(control & FAST != 0) } else { Kind::Classic };
    Frame::with_kind(of, kind, data)
}

/// Header words of an element.
fn encode(frame: &Frame) -> (u32, u32) {
    let id = match frame.id {
        Id::Standard(id) => u32::from(id.as_raw()) << 18,
        Id::Extended(id) => id.as_raw() | EXTENDED,
    };
    let (remote, kind) = match frame.kind {
        Kind::Classic => (0, 0),
        Kind::Remote => (REMOTE, 0),
        Kind::Flexible(fast) => (0, FLEXIBLE | if fast { FAST } else { 0 }),
    };
    (id | remote, kind | length_code(frame.length()) << 16)
}

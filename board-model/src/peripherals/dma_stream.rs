//! The DMA controllers of STM32F405, by streams: RM0090 section 10. Direct mode between a peripheral and memory, once
//! through.

use super::Peripheral;
use super::dma::{Transfer, Way};
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Request, Wires};

const STREAMS: u32 = 8;
const FIRST: u32 = 0x10;
const STEP: u32 = 0x18;
const NDTR: u32 = 0x04;
const PAR: u32 = 0x08;
const M0AR: u32 = 0x0c;
const FCR: u32 = 0x14;
/// Flags of a stream: FIFO error, direct mode error, transfer error, half, complete.
const FLAGS: u32 = 0x3d;
/// Where the flags of four streams begin in a register.
const PLACES: [u32; 4] = [0, 6, 16, 22];
const ALL_FLAGS: u32 = 0x0f7d_0f7d;
/// Who is on which stream and channel of DMA2: RM0090 table 43.
const DMA2: [(u32, u32, Request); 4] = [
    (0, 3, Request::SpiReceived(1)),
    (2, 3, Request::SpiReceived(1)),
    (3, 3, Request::SpiToSend(1)),
    (5, 3, Request::SpiToSend(1)),
];

static MAP: [Register; 52] = map();

/// RM0090 10.5.
const fn map() -> [Register; 52] {
    let mut map = [Register::new("DMA_LISR", 0x00, 0, ALL_FLAGS).special(u32::MAX); 52];
    map[1] = Register::new("DMA_HISR", 0x04, 0, ALL_FLAGS).special(u32::MAX);
    map[2] = Register::new("DMA_LIFCR", 0x08, 0, ALL_FLAGS).special(u32::MAX);
    map[3] = Register::new("DMA_HIFCR", 0x0c, 0, ALL_FLAGS).special(u32::MAX);
    let mut stream = 0;
    while stream < STREAMS {
        let (place, base) = (4 + 6 * stream as usize, FIRST + STEP * stream);
        map[place] = Register::new("DMA_SxCR", base, 0, 0x0fef_ffff);
        map[place + 1] = Register::new("DMA_SxNDTR", base + NDTR, 0, 0xffff);
        map[place + 2] = Register::new("DMA_SxPAR", base + PAR, 0, u32::MAX);
        map[place + 3] = Register::new("DMA_SxM0AR", base + M0AR, 0, u32::MAX);
        map[place + 4] = Register::new("DMA_SxM1AR", base + 0x10, 0, u32::MAX);
        map[place + 5] = Register::new("DMA_SxFCR", base + FCR, 0x21, 0xbf).special(bits(5, 3));
        stream += 1;
    }
    map
}

/// A controller.
#[derive(Debug)]
pub struct DmaStreams {
    registers: Registers,
    /// Items that each stream has moved.
    moved: [u32; STREAMS as usize],
}

impl Default for DmaStreams {
    fn default() -> Self {
        Self { registers: Registers::new(&MAP), moved: [0; STREAMS as usize] }
    }
}

impl DmaStreams {
    fn is_on(&self, stream: u32) -> bool {
        self.registers.is_set(FIRST + STEP * stream, 0)
    }

    fn request(&self, stream: u32) -> Option<Request> {
        let channel = self.registers.field(FIRST + STEP * stream, 25, 3);
        DMA2.iter().find(|(place, number, _)| (*place, *number) == (stream, channel)).map(|(.., request)| *request)
    }

    fn flag(&mut self, stream: u32, flag: u32) {
        let register = if stream < 4 { 0x00 } else { 0x04 };
        self.registers.change(register, flag << PLACES[stream as usize % 4], 0);
    }

    fn start(&mut self, stream: u32, wires: &mut Wires) {
        let base = FIRST + STEP * stream;
        let control = self.registers.get(base);
        let flags = self.registers.get(if stream < 4 { 0x00 } else { 0x04 }) >> PLACES[stream as usize % 4] & FLAGS;
        if flags != 0 {
            let what = format!("stream {stream} is switched on while its flags {flags:#04x} are up");
            wires.violation("DMA_SxCR", what, "RM0090 10.3.17");
        }
        if self.request(stream).is_none() {
            let what = format!("no peripheral that is modelled is on channel {} of stream {stream}", control >> 25 & 7);
            wires.violation("DMA_SxCR", what, "RM0090 10.3.3, table 43");
        }
        if self.registers.get(base + NDTR) == 0 {
            wires.violation("DMA_SxNDTR", "is 0 when the stream is switched on", "RM0090 10.5.6");
        }
        let outwards = control >> 6 & 3 == 1;
        let wanted = matches!(self.request(stream), Some(Request::SpiToSend(_)));
        if control >> 6 & 3 > 1 || outwards != wanted {
            wires.violation("DMA_SxCR", format!("stream {stream} goes the wrong way"), "RM0090 10.5.5 DIR");
        }
        if control & (bit(5) | bit(8) | bit(9) | bit(18)) != 0 || self.registers.is_set(base + FCR, 2) {
            wires.violation("DMA_SxCR", "only direct mode, once through, is modelled", "RM0090 10.3");
        }
        self.moved[stream as usize] = 0;
    }
}

impl Peripheral for DmaStreams {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, _wires: &mut Wires) -> u32 {
        match offset {
            0x08 | 0x0c => 0,
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            0x00 | 0x04 => wires.violation("DMA_ISR", "is read-only", "RM0090 10.5.1"),
            0x08 | 0x0c => self.registers.change(offset - 8, 0, value),
            _ => {
                let stream = (offset - FIRST) / STEP;
                let control = (offset - FIRST).is_multiple_of(STEP);
                let was_on = if control { before & 1 == 1 } else { self.is_on(stream) };
                // RM0090 10.5.5 to 10.5.10: all but EN itself can be written while the stream is off only.
                if was_on && (!control || value & 1 == 1 && value != before) {
                    wires.violation("DMA_Sx", format!("stream {stream} is set up while it is on"), "RM0090 10.5.5");
                }
                if control && !was_on && value & 1 == 1 {
                    self.start(stream, wires);
                }
                if control && was_on && value & 1 == 0 {
                    // RM0090 10.3.16: switching off sets the flag of the end.
                    self.flag(stream, bit(5));
                }
            }
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        for stream in 0..STREAMS {
            if let Some(request) = self.request(stream) {
                wires.serve(request, self.is_on(stream));
            }
        }
    }

    fn next_transfer(&mut self, wires: &mut Wires) -> Option<Transfer> {
        let stream = (0..STREAMS).find(|stream| {
            self.is_on(*stream) && self.request(*stream).is_some_and(|request| wires.requests.contains(&request))
        })?;
        let base = FIRST + STEP * stream;
        let control = self.registers.get(base);
        let way = Way {
            peripheral: self.registers.get(base + PAR),
            memory: self.registers.get(base + M0AR),
            rises: control & bit(10) != 0,
            outwards: control >> 6 & 3 == 1,
            size: 1 << (control >> 11 & 3),
        };
        let transfer = way.item(self.moved[stream as usize]);
        self.moved[stream as usize] += 1;
        let left = self.registers.get(base + NDTR).saturating_sub(1);
        self.registers.set(base + NDTR, left);
        if left == 0 {
            self.registers.change(base, 0, 1);
            self.flag(stream, bit(5));
            self.advance(wires);
        }
        Some(transfer)
    }

    fn reset(&mut self) {
        *self = Self::default();
    }
}

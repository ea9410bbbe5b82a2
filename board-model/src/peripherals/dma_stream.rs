//! DMA controllers of STM32F405, by streams: RM0090 section 10. Direct mode between a peripheral and memory.

use super::Peripheral;
use super::dma::{Course, Reached, Transfer, Way};
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
const HALF: u32 = bit(4);
const COMPLETE: u32 = bit(5);
/// Bits of the control register that enable the interrupts of errors, half transfer and complete transfer; each is one
/// position below its flag.
const ENABLES: u32 = bits(4, 1);
const CIRCULAR: u32 = 8;
/// Interrupts of the streams of DMA1 and DMA2: RM0090 table 61.
const INTERRUPTS: [[usize; STREAMS as usize]; 2] = [[11, 12, 13, 14, 15, 16, 17, 47], [56, 57, 58, 59, 60, 68, 69, 70]];
/// Positions of the flags of four streams in a register.
const PLACES: [u32; 4] = [0, 6, 16, 22];
const ALL_FLAGS: u32 = 0x0f7d_0f7d;
/// Requests by stream and channel of DMA1, as far as modelled: RM0090 table 42.
const DMA1: [(u32, u32, Request); 9] = [
    (0, 4, Request::UsartReceived(5)),
    (1, 4, Request::UsartReceived(3)),
    (2, 4, Request::UsartReceived(4)),
    (3, 4, Request::UsartToSend(3)),
    (4, 4, Request::UsartToSend(4)),
    (4, 7, Request::UsartToSend(3)),
    (5, 4, Request::UsartReceived(2)),
    (6, 4, Request::UsartToSend(2)),
    (7, 4, Request::UsartToSend(5)),
];
/// Requests by stream and channel of DMA2, as far as modelled: RM0090 table 43.
const DMA2: [(u32, u32, Request); 11] = [
    (0, 3, Request::SpiReceived(1)),
    (2, 3, Request::SpiReceived(1)),
    (3, 3, Request::SpiToSend(1)),
    (5, 3, Request::SpiToSend(1)),
    (2, 4, Request::UsartReceived(1)),
    (5, 4, Request::UsartReceived(1)),
    (7, 4, Request::UsartToSend(1)),
    (1, 5, Request::UsartReceived(6)),
    (2, 5, Request::UsartReceived(6)),
    (6, 5, Request::UsartToSend(6)),
    (7, 5, Request::UsartToSend(6)),
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

/// DMA controller.
#[derive(Debug)]
pub struct DmaStreams {
    registers: Registers,
    number: usize,
    courses: [Course; STREAMS as usize],
}

impl DmaStreams {
    /// Controller by its number.
    pub fn new(number: usize) -> Self {
        Self { registers: Registers::new(&MAP), number, courses: Default::default() }
    }

    fn is_on(&self, stream: u32) -> bool {
        self.registers.is_set(FIRST + STEP * stream, 0)
    }

    fn request(&self, stream: u32) -> Option<Request> {
        let channel = self.registers.field(FIRST + STEP * stream, 25, 3);
        let requests = if self.number == 1 { &DMA1[..] } else { &DMA2[..] };
        requests.iter().find(|(place, number, _)| (*place, *number) == (stream, channel)).map(|(.., request)| *request)
    }

    /// Register of a stream's flags, and their position in it.
    fn flag_place(stream: u32) -> (u32, u32) {
        (if stream < 4 { 0x00 } else { 0x04 }, PLACES[stream as usize % 4])
    }

    fn flags(&self, stream: u32) -> u32 {
        let (register, place) = Self::flag_place(stream);
        self.registers.get(register) >> place & FLAGS
    }

    fn flag(&mut self, stream: u32, flag: u32) {
        let (register, place) = Self::flag_place(stream);
        self.registers.change(register, flag << place, 0);
    }

    fn start(&mut self, stream: u32, wires: &mut Wires) {
        let base = FIRST + STEP * stream;
        let control = self.registers.get(base);
        let flags = self.flags(stream);
        if flags != 0 {
            let what = format!("stream {stream} is switched on while its flags {flags:#04x} are up");
            wires.violation("DMA_SxCR", what, "RM0090 10.3.17");
        }
        if self.request(stream).is_none() {
            let what = format!("no peripheral that is modelled is on channel {} of stream {stream}", control >> 25 & 7);
            wires.violation("DMA_SxCR", what, "RM0090 10.3.3, tables 42 and 43");
        }
        if self.registers.get(base + NDTR) == 0 {
            wires.violation("DMA_SxNDTR", "is 0 when the stream is switched on", "RM0090 10.5.6");
        }
        let outwards = control >> 6 & 3 == 1;
        let wanted = self.request(stream).is_some_and(Request::is_outwards);
        if control >> 6 & 3 > 1 || outwards != wanted {
            wires.violation("DMA_SxCR", format!("stream {stream} goes the wrong way"), "RM0090 10.5.5 DIR");
        }
        if control & (bit(5) | bit(9) | bit(18)) != 0 || self.registers.is_set(base + FCR, 2) {
            wires.violation("DMA_SxCR", "only direct mode with one buffer is modelled", "RM0090 10.3");
        }
        self.courses[stream as usize].start(&self.registers, base + NDTR);
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
                // RM0090 10.5.5 to 10.5.10: only EN itself can be written while the stream is on.
                if was_on && (!control || value & 1 == 1 && value != before) {
                    wires.violation("DMA_Sx", format!("stream {stream} is set up while it is on"), "RM0090 10.5.5");
                }
                if control && !was_on && value & 1 == 1 {
                    self.start(stream, wires);
                }
                if control && was_on && value & 1 == 0 {
                    // RM0090 10.3.16: switching off sets the end flag.
                    self.flag(stream, COMPLETE);
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
            let asks = self.flags(stream) >> 1 & ENABLES & self.registers.get(FIRST + STEP * stream) != 0;
            wires.interrupt(INTERRUPTS[self.number - 1][stream as usize], asks);
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
        let circular = control >> CIRCULAR & 1 == 1;
        let (item, reached) = self.courses[stream as usize].step(circular, &mut self.registers, base + NDTR);
        match reached {
            Reached::Nothing => {}
            Reached::Half => self.flag(stream, HALF),
            Reached::End => {
                self.flag(stream, COMPLETE);
                if !circular {
                    self.registers.change(base, 0, 1);
                }
            }
        }
        self.advance(wires);
        Some(way.item(item))
    }

    fn reset(&mut self) {
        *self = Self::new(self.number);
    }
}

//! DMA controllers of STM32G474 and STM32G431, by channels: RM0440 section 12. Transfers between a peripheral and
//! memory; the multiplexer selects the peripheral.

use super::Peripheral;
use super::dma::{Course, Reached, Transfer, Way};
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Request, Wires};

/// Maximum number of channels; the STM32G431 has six.
const CHANNELS: u32 = 8;
const ISR: u32 = 0x00;
const IFCR: u32 = 0x04;
const FIRST: u32 = 0x08;
const STEP: u32 = 0x14;
const NDTR: u32 = 0x04;
const PAR: u32 = 0x08;
const MAR: u32 = 0x0c;
/// Flags of a channel: any, complete, half. The enable bits of the last two have the same positions in the control
/// register.
const ANY: u32 = bit(0);
const COMPLETE: u32 = bit(1);
const HALF: u32 = bit(2);
const ENABLES: u32 = bits(3, 1);
const CIRCULAR: u32 = 5;
/// Interrupts of the channels of DMA1 and DMA2: RM0440 table 97.
const INTERRUPTS: [[usize; CHANNELS as usize]; 2] =
    [[11, 12, 13, 14, 15, 16, 17, 96], [56, 57, 58, 59, 60, 97, 98, 99]];

static MAP: [Register; 34] = map();

/// RM0440 12.6.
const fn map() -> [Register; 34] {
    let mut map = [Register::new("DMA_ISR", ISR, 0, u32::MAX).special(u32::MAX); 34];
    map[1] = Register::new("DMA_IFCR", IFCR, 0, u32::MAX).special(u32::MAX);
    let mut channel = 0;
    while channel < CHANNELS {
        let (place, base) = (2 + 4 * channel as usize, FIRST + STEP * channel);
        map[place] = Register::new("DMA_CCRx", base, 0, 0x7fff);
        map[place + 1] = Register::new("DMA_CNDTRx", base + NDTR, 0, 0xffff);
        map[place + 2] = Register::new("DMA_CPARx", base + PAR, 0, u32::MAX);
        map[place + 3] = Register::new("DMA_CMARx", base + MAR, 0, u32::MAX);
        channel += 1;
    }
    map
}

/// DMA controller.
#[derive(Debug)]
pub struct DmaChannels {
    registers: Registers,
    number: u32,
    channels: u32,
    courses: [Course; CHANNELS as usize],
}

impl DmaChannels {
    /// Controller by its number, with a number of channels.
    pub fn new(number: u32, channels: u32) -> Self {
        let registers = Registers::new(&MAP[..2 + 4 * channels as usize]);
        Self { registers, number, channels, courses: Default::default() }
    }

    fn is_on(&self, channel: u32) -> bool {
        self.registers.is_set(FIRST + STEP * channel, 0)
    }

    fn request(&self, channel: u32, wires: &Wires) -> Option<Request> {
        wires.routes.get(&(self.number, channel)).copied().flatten()
    }

    fn start(&mut self, channel: u32, wires: &mut Wires) {
        let base = FIRST + STEP * channel;
        let control = self.registers.get(base);
        let request = self.request(channel, wires);
        if request.is_none() {
            let what = format!("channel {} is switched on with no request that is modelled", channel + 1);
            wires.violation("DMA_CCRx", what, "RM0440 12.4.4, 13.3");
        }
        if self.registers.get(base + NDTR) == 0 {
            wires.violation("DMA_CNDTRx", "is 0 when the channel is switched on", "RM0440 12.4.4");
        }
        let outwards = control & bit(4) != 0;
        if request.is_some_and(|request| request.is_outwards() != outwards) {
            let what = format!("channel {} goes the wrong way", channel + 1);
            wires.violation("DMA_CCRx", what, "RM0440 12.6.3 DIR");
        }
        if control & (bit(6) | bit(14)) != 0 || control >> 8 & 3 != control >> 10 & 3 {
            wires.violation(
                "DMA_CCRx",
                "only items of one size are modelled, in memory one after the other",
                "RM0440 12.4",
            );
        }
        self.courses[channel as usize].start(&self.registers, base + NDTR);
    }
}

impl Peripheral for DmaChannels {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, _wires: &mut Wires) -> u32 {
        if offset == IFCR { 0 } else { self.registers.get(offset) }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            ISR => wires.violation("DMA_ISR", "is read-only", "RM0440 12.6.1"),
            IFCR => {
                // A global flag clears the other three.
                let all = (0..self.channels).filter(|channel| value >> (4 * channel) & 1 == 1);
                let mask = all.map(|channel| 0xf << (4 * channel)).fold(value, |mask, flags| mask | flags);
                self.registers.change(ISR, 0, mask);
            }
            _ => {
                let channel = (offset - FIRST) / STEP;
                let control = (offset - FIRST).is_multiple_of(STEP);
                let was_on = if control { before & 1 == 1 } else { self.is_on(channel) };
                // RM0440 12.6.3: only EN itself can be written while the channel is on.
                if was_on && (!control || value & 1 == 1 && (value ^ before) & !bits(3, 0) != 0) {
                    let what = format!("channel {} is set up while it is on", channel + 1);
                    wires.violation("DMA_CCRx", what, "RM0440 12.6.3");
                }
                if control && !was_on && value & 1 == 1 {
                    self.start(channel, wires);
                }
            }
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        for channel in 0..self.channels {
            if let Some(request) = self.request(channel, wires) {
                wires.serve(request, self.is_on(channel));
            }
            let flags = self.registers.get(ISR) >> (4 * channel) & ENABLES;
            let asks = flags & self.registers.get(FIRST + STEP * channel) != 0;
            wires.interrupt(INTERRUPTS[self.number as usize - 1][channel as usize], asks);
        }
    }

    fn next_transfer(&mut self, wires: &mut Wires) -> Option<Transfer> {
        let asks = |channel: &u32| {
            let request = self.request(*channel, wires);
            let left = self.registers.get(FIRST + STEP * channel + NDTR) > 0;
            self.is_on(*channel) && left && request.is_some_and(|request| wires.requests.contains(&request))
        };
        let channel = (0..self.channels).find(asks)?;
        let base = FIRST + STEP * channel;
        let control = self.registers.get(base);
        let way = Way {
            peripheral: self.registers.get(base + PAR),
            memory: self.registers.get(base + MAR),
            rises: control & bit(7) != 0,
            outwards: control & bit(4) != 0,
            size: 1 << (control >> 8 & 3),
        };
        let circular = control >> CIRCULAR & 1 == 1;
        let (item, reached) = self.courses[channel as usize].step(circular, &mut self.registers, base + NDTR);
        let flags = match reached {
            Reached::Nothing => 0,
            Reached::Half => ANY | HALF,
            Reached::End => ANY | COMPLETE,
        };
        self.registers.change(ISR, flags << (4 * channel), 0);
        self.advance(wires);
        Some(way.item(item))
    }

    fn reset(&mut self) {
        *self = Self::new(self.number, self.channels);
    }
}

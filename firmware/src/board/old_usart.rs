//! USART of STM32F4, which buffers one byte, while a tick may delay its interrupt for longer than a byte takes. A DMA
//! stream moves received bytes into a ring; each tick requests the interrupt, which reads the ring. Without this stream
//! (emulated board, detected by registers that do not read back) each byte raises the interrupt, and the emulated line
//! waits for it.

use core::cell::UnsafeCell;
use core::sync::atomic::AtomicBool;
use core::sync::atomic::Ordering::Relaxed;

use super::pac;
use super::serial_unit::{Registers, wake};
use crate::serial::Uart;

/// Bytes of the ring: nearly three milliseconds at 921,600 baud.
const RING: usize = 256;
/// Settings of the stream: circular, incrementing memory addresses, high priority.
const SETTINGS: u32 = 1 << 8 | 1 << 10 | 2 << 16;
const ENABLE: u32 = 1;
/// Flags of a stream, shifted to bit 0: end of the ring passed, middle passed.
const END: u32 = 1 << 5;
const MIDDLE: u32 = 1 << 4;
const FLAGS: u32 = 0x3d;

/// Controller (1 or 2), stream, and channel of the line's unit.
#[cfg(serial = "usart1")]
const STREAM: (u8, usize, u32) = (2, 5, 4);
#[cfg(serial = "usart2")]
const STREAM: (u8, usize, u32) = (1, 5, 4);
#[cfg(serial = "usart3")]
const STREAM: (u8, usize, u32) = (1, 1, 4);
#[cfg(serial = "uart4")]
const STREAM: (u8, usize, u32) = (1, 2, 4);
#[cfg(serial = "uart5")]
const STREAM: (u8, usize, u32) = (1, 0, 4);
#[cfg(serial = "usart6")]
const STREAM: (u8, usize, u32) = (2, 1, 5);

/// Buffer written by the stream; the core only reads it.
struct Ring(UnsafeCell<[u8; RING]>);

// SAFETY: one interrupt reads it, by volatile reads.
unsafe impl Sync for Ring {}

static RECEIVED: Ring = Ring(UnsafeCell::new([0; RING]));

/// The stream receives; each tick requests the interrupt.
static BY_STREAM: AtomicBool = AtomicBool::new(false);

/// Requests the interrupt if the stream receives.
pub fn look() {
    if BY_STREAM.load(Relaxed) {
        wake();
    }
}

/// The USART.
pub struct OldUsart {
    registers: Registers,
    /// Index of the next byte to read in the ring; `None` if each byte raises the interrupt.
    place: Option<usize>,
    overran: bool,
}

impl OldUsart {
    /// Opens the USART: 8 data bits, no parity, one stop bit.
    pub fn open(registers: Registers, clocks: &pac::RCC, clock: u32, baud_rate: u32) -> Self {
        // SAFETY: the quotient is a valid divider for 16-fold oversampling.
        registers.brr().write(|w| unsafe { w.bits(((clock + baud_rate / 2) / baud_rate) as u16) });
        let by_stream = start_stream(clocks, registers.dr().as_ptr() as u32);
        BY_STREAM.store(by_stream, Relaxed);
        registers.cr3().modify(|_, w| w.dmar().bit(by_stream));
        registers.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit().rxneie().bit(!by_stream));
        Self { registers, place: by_stream.then_some(0), overran: false }
    }

    /// Takes a byte from the ring.
    fn take(&mut self, place: usize) -> Option<u8> {
        let end = RING - (stream().ndtr().read().bits() as usize).min(RING);
        if place == end % RING {
            return None;
        }
        self.place = Some((place + 1) % RING);
        // SAFETY: the place is within the ring, and every byte is one.
        Some(unsafe { RECEIVED.0.get().cast::<u8>().add(place).read_volatile() })
    }
}

impl Uart for OldUsart {
    fn read(&mut self) -> Option<u8> {
        let status = self.registers.sr().read();
        let lost = status.ore().bit_is_set();
        self.overran |= lost;
        match self.place {
            Some(place) => {
                if lost {
                    // Reading the data after the status clears it.
                    let _ = self.registers.dr().read();
                }
                self.take(place)
            }
            None => (status.rxne().bit_is_set() || lost).then(|| self.registers.dr().read().dr().bits() as u8),
        }
    }

    fn overran(&mut self) -> bool {
        let lapped = self.place.is_some() && has_passed_both();
        core::mem::take(&mut self.overran) | lapped
    }

    fn can_write(&self) -> bool {
        self.registers.sr().read().txe().bit_is_set()
    }

    fn write(&mut self, byte: u8) {
        // SAFETY: any nine bits may be sent.
        self.registers.dr().write(|w| unsafe { w.dr().bits(byte.into()) });
    }

    fn interrupt_on_write(&mut self, on: bool) {
        self.registers.cr1().modify(|_, w| w.txeie().bit(on));
    }

    fn interrupt_again(&mut self) {
        wake();
    }
}

fn controller() -> &'static pac::dma1::RegisterBlock {
    let controller = if STREAM.0 == 1 { pac::DMA1::ptr() } else { pac::DMA2::ptr() };
    // SAFETY: of the controller, the stream is the line's, and flags are cleared by ones.
    unsafe { &*controller }
}

fn stream() -> &'static pac::dma1::ST {
    controller().st(STREAM.1)
}

/// Returns `true` if the stream has passed both middle and end of the ring since the last call: a whole ring may have
/// arrived while flash was written. One call per tick never sees both.
fn has_passed_both() -> bool {
    let (controller, shift) = (controller(), [0, 6, 16, 22][STREAM.1 % 4]);
    let (flags, both) = (FLAGS << shift, (END | MIDDLE) << shift);
    // SAFETY: ones clear the flags of the line's stream.
    let passed = unsafe {
        if STREAM.1 < 4 {
            let passed = controller.lisr().read().bits();
            controller.lifcr().write(|w| w.bits(flags));
            passed
        } else {
            let passed = controller.hisr().read().bits();
            controller.hifcr().write(|w| w.bits(flags));
            passed
        }
    };
    passed & both == both
}

/// Starts the stream from a data register to the ring; returns `false` if there is no stream.
fn start_stream(clocks: &pac::RCC, data: u32) -> bool {
    clocks.ahb1enr().modify(|_, w| if STREAM.0 == 1 { w.dma1en().set_bit() } else { w.dma2en().set_bit() });
    let _ = clocks.ahb1enr().read();
    let stream = stream();
    let settings = STREAM.2 << 25 | SETTINGS;
    // SAFETY: the data register, the ring, which lives for ever, and its length; a stream that is off may have any settings.
    unsafe {
        stream.par().write(|w| w.bits(data));
        stream.m0ar().write(|w| w.bits(RECEIVED.0.get() as u32));
        stream.ndtr().write(|w| w.bits(RING as u32));
        stream.cr().write(|w| w.bits(settings));
        stream.cr().write(|w| w.bits(settings | ENABLE));
    }
    stream.cr().read().bits() == settings | ENABLE
}

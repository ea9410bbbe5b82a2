//! SPI slave of STM32F405 with DMA: mode 0, 8 bits, hardware chip select. The chip takes a clock of at most 42 MHz, 21
//! MHz with long wires; the board file selects unit and pins.

use super::bounded_wait::wait_until;
use super::dma_slave::Unit;
use super::gpio::Pin;
use super::pac;
use crate::port::spi::FRAME_BYTES;

/// Registers, DMA and clock of each unit.
macro_rules! units {
    ($($name:literal => $spi:ident, $gates:ident, $gate:ident, $resets:ident, $reset:ident, $dma:ident, $dma_gate:ident,
        $receiving:literal, $sending:literal, $channel:literal;)+) => {$(
        #[cfg(spi_slave = $name)]
        mod unit {
            use super::pac;

            pub type Spi = pac::$spi;
            pub type Dma = pac::$dma;
            /// Streams.
            pub const RECEIVING: usize = $receiving;
            pub const SENDING: usize = $sending;
            /// Channel number of the unit for both streams, as in the stream's register.
            pub const CHANNEL: u32 = $channel << 25;

            /// The unit and the DMA with their clocks on.
            pub fn take(device: pac::Peripherals) -> (Spi, Dma, pac::RCC, pac::EXTI, pac::SYSCFG) {
                let pac::Peripherals { $spi: spi, $dma: dma, RCC: clocks, EXTI: exti, SYSCFG: syscfg, .. } = device;
                clocks.ahb1enr().modify(|_, w| w.$dma_gate().set_bit());
                let _ = clocks.ahb1enr().read();
                clocks.$gates().modify(|_, w| w.$gate().set_bit());
                let _ = clocks.$gates().read();
                clocks.apb2enr().modify(|_, w| w.syscfgen().set_bit());
                let _ = clocks.apb2enr().read();
                (spi, dma, clocks, exti, syscfg)
            }

            pub fn reset(clocks: &pac::RCC) {
                clocks.$resets().modify(|_, w| w.$reset().set_bit());
                clocks.$resets().modify(|_, w| w.$reset().clear_bit());
            }
        }
    )+};
}

units! {
    "spi1" => SPI1, apb2enr, spi1en, apb2rstr, spi1rst, DMA2, dma2en, 0, 3, 3;
    "spi2" => SPI2, apb1enr, spi2en, apb1rstr, spi2rst, DMA1, dma1en, 3, 4, 0;
    "spi3" => SPI3, apb1enr, spi3en, apb1rstr, spi3rst, DMA1, dma1en, 0, 5, 0;
}
use unit::{CHANNEL, Dma, RECEIVING, SENDING, Spi};

/// Incrementing memory addresses.
const MEMORY_RISES: u32 = 1 << 10;
/// Direction from memory to the peripheral.
const OUTWARDS: u32 = 1 << 6;
const ENABLE: u32 = 1;
/// All flags of a stream, from its first bit on.
const FLAGS: u32 = 0x3d;

/// SPI unit with two DMA streams.
pub struct StreamSpi {
    spi: Spi,
    dma: Dma,
    exti: pac::EXTI,
    clocks: pac::RCC,
    /// EXTI line of the chip select.
    line: u32,
}

impl StreamSpi {
    /// Stops a stream; a transfer of a byte in progress is completed.
    fn end(&self, stream: usize) {
        let control = self.dma.st(stream).cr();
        // SAFETY: a stream that is off may have any settings.
        control.write(|w| unsafe { w.bits(0) });
        let _ = wait_until(|| control.read().bits() & ENABLE == 0);
    }

    /// Starts a stream between the data register and a buffer.
    fn set(&self, stream: usize, buffer: u32, direction: u32) {
        let registers = self.dma.st(stream);
        let data = self.spi.dr().as_ptr() as u32;
        // SAFETY: the data register, a buffer of a frame's length that lives for ever, and that length.
        unsafe {
            registers.par().write(|w| w.bits(data));
            registers.m0ar().write(|w| w.bits(buffer));
            registers.ndtr().write(|w| w.bits(FRAME_BYTES as u32));
            registers.cr().write(|w| w.bits(CHANNEL | MEMORY_RISES | direction | ENABLE));
        }
    }
}

impl Unit for StreamSpi {
    fn start(device: pac::Peripherals, select: Pin) -> Self {
        let (spi, dma, clocks, exti, syscfg) = unit::take(device);
        let line = 1 << select.number;
        let (port, shift) = (u32::from(select.port), 4 * u32::from(select.number % 4));
        let to_port = |bits: u32| bits & !(0xf << shift) | port << shift;
        // SAFETY: of the register only the field of this line changes, to the port of the chip select.
        unsafe {
            match select.number / 4 {
                0 => syscfg.exticr1().modify(|r, w| w.bits(to_port(r.bits()))),
                1 => syscfg.exticr2().modify(|r, w| w.bits(to_port(r.bits()))),
                2 => syscfg.exticr3().modify(|r, w| w.bits(to_port(r.bits()))),
                _ => syscfg.exticr4().modify(|r, w| w.bits(to_port(r.bits()))),
            };
        }
        // SAFETY: every line may have an edge and an interrupt.
        exti.rtsr().modify(|r, w| unsafe { w.bits(r.bits() | line) });
        // SAFETY: every line may have an interrupt.
        exti.imr().modify(|r, w| unsafe { w.bits(r.bits() | line) });
        Self { spi, dma, exti, clocks, line }
    }

    fn acknowledge(&mut self) {
        // SAFETY: a one takes back this line's request.
        self.exti.pr().write(|w| unsafe { w.bits(self.line) });
    }

    fn missing(&self) -> u16 {
        self.dma.st(RECEIVING).ndtr().read().bits() as u16
    }

    fn overran(&self) -> bool {
        self.spi.sr().read().ovr().bit_is_set()
    }

    fn has_byte(&self) -> bool {
        self.spi.sr().read().rxne().bit_is_set()
    }

    fn stop(&mut self) {
        self.end(RECEIVING);
        self.end(SENDING);
        unit::reset(&self.clocks);
    }

    fn begin(&mut self, received: u32, sent: u32) {
        for stream in [RECEIVING, SENDING] {
            let flags = FLAGS << [0, 6, 16, 22][stream % 4];
            // SAFETY: ones clear flags.
            unsafe {
                match stream / 4 {
                    0 => self.dma.lifcr().write(|w| w.bits(flags)),
                    _ => self.dma.hifcr().write(|w| w.bits(flags)),
                };
            }
        }
        self.set(RECEIVING, received, 0);
        self.spi.cr2().write(|w| w.rxdmaen().enabled().txdmaen().enabled());
        self.set(SENDING, sent, OUTWARDS);
        // All other settings as after reset: slave, mode 0, 8 bits, hardware chip select.
        cortex_m::asm::dmb();
        self.spi.cr1().write(|w| w.spe().enabled());
    }
}

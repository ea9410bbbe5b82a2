//! AS5047P, a 14-bit magnetic encoder on SPI (mode 1, at most 10 MHz). Each tick transfers one frame of 16 bits: it
//! sends a command and receives the answer to the previous command. ABI, PWM and programming are not supported. The bus
//! driver must provide 350 ns between select and clock and between frames.
//!
//! Frame: bit 15 makes the parity even. Bit 14 means "read" in a command and "previous command faulty" in an answer. 14
//! bits carry address or content. An idle line reads as all ones or all zeros, both with valid parity. All ones are
//! rejected by the error bit; all zeros may be an angle, so the diagnostics, which are never zero, are read.
//!
//! Every `BETWEEN_LOOKS` readings two more frames read the diagnostics: a magnet that is too weak, too strong or
//! missing gives wrong angles without an error flag. While the diagnostics report a magnet fault, there is no reading.

use embedded_hal::spi::SpiDevice;
use model_core::observer::Reading;

use super::{CountSource, EncoderFault};

/// Bit 14 of a command: read.
const READ: u16 = 1 << 14;
/// Bit 14 of an answer: the previous command was faulty.
const ERROR: u16 = 1 << 14;
const CONTENT: u16 = (1 << 14) - 1;
/// Readings between two reads of the diagnostics: 26 ms at 10 kHz.
const BETWEEN_LOOKS: u16 = 256;
/// Bits of the diagnostics: ready, angle overflow, field too strong, field too weak.
const READY: u16 = 1 << 8;
const OVERFLOW: u16 = 1 << 9;
const STRONG: u16 = 1 << 10;
const WEAK: u16 = 1 << 11;
/// Content of an undriven line with pull-up.
const NOBODY_HIGH: u16 = u16::MAX;
/// Content of an undriven line with pull-down.
const NOBODY_LOW: u16 = 0;

/// Registers in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Register {
    /// ERRFL; reading clears it.
    Errors = 0x0001,
    /// DIAAGC: gain and alarms.
    Diagnostics = 0x3ffc,
    /// ANGLECOM: angle, compensated for the delay of the chip's filters.
    Angle = 0x3fff,
}

impl Register {
    fn command(self) -> u16 {
        let command = READ | self as u16;
        if command.count_ones().is_multiple_of(2) { command } else { command | 1 << 15 }
    }
}

/// Encoder on its bus.
#[derive(Debug)]
pub struct As5047p<S> {
    spi: S,
    /// Request time of the angle that the next frame delivers.
    asked: Option<u32>,
    /// Readings until the next read of the diagnostics.
    until_look: u16,
    /// Magnet fault found by the last read of the diagnostics.
    magnet: Option<EncoderFault>,
}

/// Magnet fault by the diagnostics. Without a magnet the field is too weak and the other bits are meaningless.
fn magnet_fault(diagnostics: u16) -> Option<EncoderFault> {
    let has = |flag: u16| diagnostics & flag != 0;
    match (has(WEAK), has(STRONG)) {
        (true, false) if has(OVERFLOW) || !has(READY) => Some(EncoderFault::MagnetLost),
        (true, false) => Some(EncoderFault::MagnetTooWeak),
        (false, true) => Some(EncoderFault::MagnetTooStrong),
        // Both at once, or an angle overflow in a good field: no magnet behaves like this.
        (true, true) => Some(EncoderFault::MagnetLost),
        (false, false) => has(OVERFLOW).then_some(EncoderFault::MagnetLost),
    }
}

impl<S: SpiDevice> As5047p<S> {
    /// Encoder before the first request.
    pub fn new(spi: S) -> Self {
        Self { spi, asked: None, until_look: 0, magnet: None }
    }

    /// Returns the bus.
    pub fn release(self) -> S {
        self.spi
    }

    /// Sends a command; returns the answer to the previous command.
    fn exchange(&mut self, next: Register) -> Result<u16, EncoderFault> {
        let mut frame = next.command().to_be_bytes();
        self.spi.transfer_in_place(&mut frame).map_err(|_| EncoderFault::Bus)?;
        Ok(u16::from_be_bytes(frame))
    }

    /// Reads another register with two more frames and requests the angle again.
    fn read_register(&mut self, register: Register) -> Result<u16, EncoderFault> {
        self.exchange(register)?;
        let frame = self.exchange(Register::Angle)?;
        if frame.count_ones().is_multiple_of(2) { Ok(frame & CONTENT) } else { Err(EncoderFault::Parity) }
    }
}

impl<S: SpiDevice> CountSource for As5047p<S> {
    const COUNTS_PER_TURN: u32 = 1 << 14;

    fn read(&mut self, now: u32) -> Result<Reading, EncoderFault> {
        let before = self.asked.take();
        let frame = self.exchange(Register::Angle)?;
        self.asked = Some(now);
        let Some(time) = before else { return Err(EncoderFault::Pending) };
        if frame == NOBODY_HIGH {
            return Err(EncoderFault::Missing);
        }
        if !frame.count_ones().is_multiple_of(2) {
            return Err(EncoderFault::Parity);
        }
        if frame & ERROR != 0 {
            // Reading the error register also clears the flag.
            return Err(EncoderFault::Reported(self.read_register(Register::Errors)?));
        }
        if frame == NOBODY_LOW || self.until_look == 0 {
            let diagnostics = self.read_register(Register::Diagnostics)?;
            if diagnostics == 0 {
                return Err(EncoderFault::Missing);
            }
            self.magnet = magnet_fault(diagnostics);
            self.until_look = BETWEEN_LOOKS;
        }
        self.until_look -= 1;
        if let Some(fault) = self.magnet {
            return Err(fault);
        }
        Ok(Reading { counts: (frame & CONTENT).into(), time })
    }
}

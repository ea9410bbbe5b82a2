//! AS5047P, a 14-bit magnetic encoder on SPI (mode 1, at most 10 MHz): one frame of 16 bits a tick, each carrying a
//! command and the answer to the one before. Its ABI, PWM and programming are left out. It wants 350 ns between select and clock, and
//! between frames: that is the bus's business.
//!
//! A frame: bit 15 makes the parity even; bit 14 of a command says "read", of an answer that the command before was
//! faulty; 14 bits of address or content. An idle line gives all ones or all zeros, both with a good parity: all ones is
//! no angle since it reports an error, all zeros may be one, so the diagnostics are asked for, which are never zero.
//!
//! Now and then the diagnostics are asked for in two frames more: a magnet that is too weak, too strong or gone gives angles that
//! are none, without an error flag. While that is so there is no reading.

use embedded_hal::spi::SpiDevice;
use model_core::observer::Reading;

use super::{CountSource, EncoderFault};

/// Bit 14 of a command: read.
const READ: u16 = 1 << 14;
/// Bit 14 of an answer: the command before was faulty.
const ERROR: u16 = 1 << 14;
const CONTENT: u16 = (1 << 14) - 1;
/// Readings from one look at the diagnostics to the next: 26 ms at 10 kHz.
const BETWEEN_LOOKS: u16 = 256;
/// Of the diagnostics: ready, angle overflowed, field too strong, field too weak.
const READY: u16 = 1 << 8;
const OVERFLOW: u16 = 1 << 9;
const STRONG: u16 = 1 << 10;
const WEAK: u16 = 1 << 11;
/// What a line gives that is pulled up and nobody drives.
const NOBODY_HIGH: u16 = u16::MAX;
/// The same, pulled down.
const NOBODY_LOW: u16 = 0;

/// What can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Register {
    /// ERRFL; reading clears it.
    Errors = 0x0001,
    /// DIAAGC: gain and alarms.
    Diagnostics = 0x3ffc,
    /// ANGLECOM: angle, the delay of the chip's own filters taken out.
    Angle = 0x3fff,
}

impl Register {
    fn command(self) -> u16 {
        let command = READ | self as u16;
        if command.count_ones().is_multiple_of(2) { command } else { command | 1 << 15 }
    }
}

/// The encoder on its bus.
#[derive(Debug)]
pub struct As5047p<S> {
    spi: S,
    /// When the angle was asked for that the next frame answers.
    asked: Option<u32>,
    /// Readings until the next look at the diagnostics.
    until_look: u16,
    /// What the last look found wrong with the magnet.
    magnet: Option<EncoderFault>,
}

/// What the diagnostics say of the magnet. Without one, the field is too weak and the rest of them is of nothing.
fn judged(diagnostics: u16) -> Option<EncoderFault> {
    let has = |flag: u16| diagnostics & flag != 0;
    match (has(WEAK), has(STRONG)) {
        (true, false) if has(OVERFLOW) || !has(READY) => Some(EncoderFault::MagnetLost),
        (true, false) => Some(EncoderFault::MagnetTooWeak),
        (false, true) => Some(EncoderFault::MagnetTooStrong),
        // Both at once, or an angle that overflowed in a good field: nothing that a magnet does.
        (true, true) => Some(EncoderFault::MagnetLost),
        (false, false) => has(OVERFLOW).then_some(EncoderFault::MagnetLost),
    }
}

impl<S: SpiDevice> As5047p<S> {
    /// An encoder that has not been asked anything yet.
    pub fn new(spi: S) -> Self {
        Self { spi, asked: None, until_look: 0, magnet: None }
    }

    /// Gives the bus back.
    pub fn release(self) -> S {
        self.spi
    }

    /// Sends a command; the frame that comes back answers the command before.
    fn exchange(&mut self, next: Register) -> Result<u16, EncoderFault> {
        let mut frame = next.command().to_be_bytes();
        self.spi.transfer_in_place(&mut frame).map_err(|_| EncoderFault::Bus)?;
        Ok(u16::from_be_bytes(frame))
    }

    /// Content of another register, in two frames more; the angle is asked for again behind it.
    fn aside(&mut self, register: Register) -> Result<u16, EncoderFault> {
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
            // Reading the reason also clears the flag.
            return Err(EncoderFault::Reported(self.aside(Register::Errors)?));
        }
        if frame == NOBODY_LOW || self.until_look == 0 {
            let diagnostics = self.aside(Register::Diagnostics)?;
            if diagnostics == 0 {
                return Err(EncoderFault::Missing);
            }
            self.magnet = judged(diagnostics);
            self.until_look = BETWEEN_LOOKS;
        }
        self.until_look -= 1;
        if let Some(fault) = self.magnet {
            return Err(fault);
        }
        Ok(Reading { counts: (frame & CONTENT).into(), time })
    }
}

//! AS5047P, a magnetic encoder on SPI outside of the chip, which is its master: frames, parity, error register and
//! diagnostics by its data sheet (DS000324, "SPI Interface" and "Register Description"), not by the firmware's driver.
//! Its other registers, ABI and PWM are not modelled.

use crate::wires::{Pin, SECOND, Time};

const ERRFL: u16 = 0x0001;
const DIAAGC: u16 = 0x3ffc;
const ANGLECOM: u16 = 0x3fff;
const NOP: u16 = 0x0000;
/// Errors of a frame: wrong number of bits, unknown register, wrong parity.
const FRAMING: u16 = 1;
const INVALID_COMMAND: u16 = 2;
const PARITY: u16 = 4;
/// Bit 14: read in a command, error of the previous command in an answer.
const READ: u16 = 1 << 14;
const ERROR: u16 = 1 << 14;
const CONTENT: u16 = READ - 1;

/// Diagnostics in normal operation: the loops have settled, the gain is in the middle.
pub const WELL: u16 = 1 << 8 | 0x80;
/// Diagnostics of a faulty magnet: MAGL with maximum gain, MAGH with minimum gain, and COF for an almost absent field.
pub const TOO_WEAK: u16 = 1 << 11 | 1 << 8 | 0xff;
/// See [`TOO_WEAK`].
pub const TOO_STRONG: u16 = 1 << 10 | 1 << 8;
/// See [`TOO_WEAK`].
pub const LOST: u16 = 1 << 11 | 1 << 9 | 0xff;

/// Minimum times of a bit, from select to the first edge, and of select being high between frames: table "SPI Timing".
const BIT: Time = SECOND / 10_000_000;
const SELECTED: Time = SECOND / 1_000_000_000 * 350;
const BETWEEN: Time = SELECTED;

/// Encoder with its wires.
#[derive(Debug)]
pub struct As5047p {
    /// SPI peripheral of the chip that the encoder is connected to.
    pub spi: u32,
    /// Select pin, low during a frame.
    pub select: Pin,
    /// Content of ANGLECOM.
    pub angle: u16,
    /// Content of DIAAGC.
    pub diagnostics: u16,
    /// Bits that the line inverts in every answer.
    pub disturbed: u16,
    errors: u16,
    in_error: bool,
    is_selected: bool,
    since: Time,
    command: u16,
    answer: u16,
    bytes: usize,
}

impl As5047p {
    /// Encoder with a good magnet.
    pub fn new(spi: u32, select: Pin) -> Self {
        Self {
            spi,
            select,
            angle: 0,
            diagnostics: WELL,
            disturbed: 0,
            errors: 0,
            in_error: false,
            is_selected: false,
            since: 0,
            command: 0,
            answer: 0,
            bytes: 0,
        }
    }

    /// Sets the level of select; returns the timing rule that was violated.
    pub fn selected(&mut self, is_low: bool, now: Time) -> Option<&'static str> {
        if is_low == self.is_selected {
            return None;
        }
        let pause = now - self.since;
        (self.is_selected, self.since) = (is_low, now);
        if is_low {
            (self.bytes, self.command) = (0, 0);
            return (pause < BETWEEN).then_some("is selected again in less than 350 ns");
        }
        let command = (self.bytes > 0).then_some(self.command)?;
        self.take(command);
        None
    }

    /// Executes a complete frame and prepares the answer for the next one.
    fn take(&mut self, command: u16) {
        let address = command & CONTENT;
        let error = if self.bytes != 2 {
            FRAMING
        } else if !command.count_ones().is_multiple_of(2) {
            PARITY
        } else if command & READ == 0 && address != NOP || ![NOP, ERRFL, DIAAGC, ANGLECOM].contains(&address) {
            INVALID_COMMAND
        } else {
            0
        };
        self.errors |= error;
        self.in_error = error != 0;
        let content = match address {
            _ if error != 0 => 0,
            ERRFL => std::mem::take(&mut self.errors),
            DIAAGC => self.diagnostics,
            ANGLECOM => self.angle & CONTENT,
            _ => 0,
        };
        let answer = content | if self.in_error { ERROR } else { 0 };
        self.answer = answer | (answer.count_ones() as u16 & 1) << 15;
    }

    /// Exchanges eight bits, highest first, in a mode (CPOL, CPHA); returns the answer and the rule that was violated.
    pub fn exchange(&mut self, byte: u8, mode: (bool, bool), bit: Time, now: Time) -> (u8, Option<&'static str>) {
        if !self.is_selected {
            return (0xff, None);
        }
        let wrong = if mode != (false, true) {
            Some("is clocked in another mode than 1, the only one that it has")
        } else if bit < BIT {
            Some("is clocked faster than 10 MHz")
        } else if self.bytes == 0 && now - self.since < SELECTED {
            Some("is clocked less than 350 ns after it was selected")
        } else {
            None
        };
        let answer = (self.answer ^ self.disturbed).to_be_bytes().get(self.bytes).copied().unwrap_or(0);
        self.command = self.command << 8 | u16::from(byte);
        self.bytes += 1;
        (answer, wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wires::MICROSECOND;

    /// Answers to a sequence of frames.
    fn frames(encoder: &mut As5047p, commands: &[&[u8]]) -> Vec<u16> {
        let (mut now, mut back) = (MICROSECOND, Vec::new());
        for command in commands {
            assert_eq!(encoder.selected(true, now), None);
            now += MICROSECOND;
            let bytes: Vec<u8> =
                command.iter().map(|byte| encoder.exchange(*byte, (false, true), BIT, now).0).collect();
            back.push(bytes.iter().fold(0, |word, byte| word << 8 | u16::from(*byte)));
            assert_eq!(encoder.selected(false, now), None);
            now += MICROSECOND;
        }
        back
    }

    #[test]
    fn answer_in_next_frame_with_even_parity() {
        let mut encoder = As5047p::new(1, Pin('A', 4));
        encoder.angle = 0x1235;
        let back = frames(&mut encoder, &[&[0xff, 0xff], &[0xff, 0xfc], &[0xff, 0xff]]);
        assert_eq!(back[1..], [0x1235, 0x0180]);
    }

    /// In the next frame, and by a register that is cleared when read.
    #[test]
    fn errors_reported_until_read() {
        let mut encoder = As5047p::new(1, Pin('A', 4));
        // A wrong parity, an unknown register, and half a frame.
        let back =
            frames(&mut encoder, &[&[0x7f, 0xff], &[0xc0, 0x05], &[0xff], &[0x40, 0x01], &[0x40, 0x01], &[0, 0]]);
        assert_eq!(back[1..3], [0xc000, 0xc0]);
        assert_eq!(back[3..], [0xc000, 0x8007, 0]);
    }

    #[test]
    fn data_sheet_violations_reported() {
        let mut encoder = As5047p::new(1, Pin('A', 4));
        assert_eq!(encoder.selected(true, MICROSECOND), None);
        let told = |encoder: &mut As5047p, mode, bit, now| encoder.exchange(0, mode, bit, now).1.unwrap_or_default();
        assert!(told(&mut encoder, (false, true), BIT, MICROSECOND).contains("after it was selected"));
        let later = 3 * MICROSECOND;
        assert!(told(&mut encoder, (false, false), BIT, later).contains("mode"));
        assert!(told(&mut encoder, (false, true), BIT / 2, later).contains("10 MHz"));
        encoder.selected(false, later);
        assert!(encoder.selected(true, later + BETWEEN / 2).is_some_and(|what| what.contains("again")));
    }
}

//! Detects good frames in passing bytes without storing them, so that a receiver knows at once of a good frame or a
//! stop, however long the message itself waits. Bounded work per byte.

use crc::{Digest, Table};

use crate::framing::{CRC, CRC_BYTES, MAX_FRAME, UNCHANGED};

/// Frame with a correct checksum, as [`Scanner`] reports it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Scanned {
    /// Bytes of the message.
    pub length: usize,
    /// First byte of the message: its variant number.
    pub first: u8,
}

/// Scanner of a line. It accepts the frames that [`Receiver`](crate::framing::Receiver) accepts, and also frames with
/// unknown content, which it does not check.
#[derive(Clone)]
pub struct Scanner {
    checksum: Digest<'static, u32, Table<1>>,
    /// Encoded bytes since the last zero.
    stuffed: usize,
    /// Decoded bytes since the last zero.
    plain: usize,
    first: u8,
    /// Bytes before the next code byte of COBS.
    left: u8,
    /// The next code byte stands for a zero.
    zero_next: bool,
}

impl Default for Scanner {
    fn default() -> Self {
        Self::new()
    }
}

impl Scanner {
    /// Scanner that waits for the first frame.
    pub fn new() -> Self {
        Self { checksum: CRC.digest(), stuffed: 0, plain: 0, first: 0, left: 0, zero_next: false }
    }

    /// Takes one byte; returns the frame if the byte ended a good frame.
    pub fn push(&mut self, byte: u8) -> Option<Scanned> {
        if byte == 0 {
            return core::mem::take(self).ended();
        }
        self.stuffed = self.stuffed.saturating_add(1);
        match self.left.checked_sub(1) {
            Some(left) => {
                self.left = left;
                self.take(byte);
            }
            None => {
                if self.zero_next {
                    self.take(0);
                }
                self.left = byte - 1;
                self.zero_next = byte != u8::MAX;
            }
        }
        None
    }

    fn take(&mut self, byte: u8) {
        if self.plain == 0 {
            self.first = byte;
        }
        self.plain = self.plain.saturating_add(1);
        self.checksum.update(&[byte]);
    }

    fn ended(self) -> Option<Scanned> {
        let whole = self.left == 0 && self.stuffed <= MAX_FRAME;
        // Rejects the empty message: its checksum is all zeros, which noise can produce.
        let length = self.plain.checked_sub(CRC_BYTES).filter(|length| *length > 0)?;
        (whole && self.checksum.finalize() == UNCHANGED).then_some(Scanned { length, first: self.first })
    }
}

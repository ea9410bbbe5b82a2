//! Frames as they go by, told without keeping a byte of them: for whoever must know at once that a good frame has come, and
//! whether it is a stop, however long the message itself has to wait. The same few instructions for every byte.

use crc::{Digest, Table};

use crate::framing::{CRC, CRC_BYTES, MAX_FRAME, UNCHANGED};

/// A frame with a right checksum, as [`Scanner`] tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Scanned {
    /// Bytes of the message.
    pub length: usize,
    /// The first of them, which says what kind of message it is.
    pub first: u8,
}

/// Follows the bytes of a line: the same frames are good to it as to [`Receiver`](crate::framing::Receiver), but for content
/// that is of no message, which it does not look at.
#[derive(Clone)]
pub struct Scanner {
    checksum: Digest<'static, u32, Table<1>>,
    /// Bytes since the last zero.
    stuffed: usize,
    /// Bytes that they stand for.
    plain: usize,
    first: u8,
    /// Bytes to the next code byte of COBS.
    left: u8,
    /// A zero stood before that code byte.
    zero_next: bool,
}

impl Default for Scanner {
    fn default() -> Self {
        Self::new()
    }
}

impl Scanner {
    /// Waits for the first frame.
    pub fn new() -> Self {
        Self { checksum: CRC.digest(), stuffed: 0, plain: 0, first: 0, left: 0, zero_next: false }
    }

    /// Takes one byte; returns what a good frame was if the byte ended one.
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
        // The checksum of nothing is nothing but zeros, which noise may well be: no message is empty.
        let length = self.plain.checked_sub(CRC_BYTES).filter(|length| *length > 0)?;
        (whole && self.checksum.finalize() == UNCHANGED).then_some(Scanned { length, first: self.first })
    }
}

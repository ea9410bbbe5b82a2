//! Messages on a byte stream: postcard, CRC-32 (ISO-HDLC, little-endian), COBS, a zero byte. A receiver that starts in
//! mid-frame, or meets garbage, is synchronised again after the next zero byte; it counts the frames that it drops.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use heapless::Vec;
use postcard::ser_flavors::Flavor;
use serde::{Serialize, de::DeserializeOwned};

/// Longest message before stuffing, CRC included.
pub const MAX_MESSAGE: usize = 512;
/// Longest frame on the wire: COBS adds a byte in 254 and one more, then the closing zero.
pub const MAX_FRAME: usize = MAX_MESSAGE + MAX_MESSAGE / 254 + 3;

pub(crate) const CRC_BYTES: usize = 4;
pub(crate) static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);
/// The CRC over a message and its own CRC, if neither has changed on the way.
pub(crate) const UNCHANGED: u32 = CRC_32_ISO_HDLC.residue ^ CRC_32_ISO_HDLC.xorout;

/// A message that does not fit into [`MAX_MESSAGE`] bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLong;

/// Puts a message with its checksum at the start of a buffer; says how long both are.
fn plain<M: Serialize>(message: &M, buffer: &mut [u8]) -> Result<usize, TooLong> {
    let room = buffer.len().checked_sub(CRC_BYTES).ok_or(TooLong)?;
    let length = postcard::to_slice(message, buffer.get_mut(..room).ok_or(TooLong)?).map_err(|_| TooLong)?.len();
    let checksum = CRC.checksum(buffer.get(..length).ok_or(TooLong)?);
    let place = buffer.get_mut(length..length + CRC_BYTES).ok_or(TooLong)?;
    place.copy_from_slice(&checksum.to_le_bytes());
    Ok(length + CRC_BYTES)
}

/// The frame that carries a message.
///
/// ```
/// use link::framing::{Receiver, encode};
/// use link::messages::ToBoard;
///
/// let sent = ToBoard::Hello { protocol: link::PROTOCOL_VERSION };
/// let mut frame = encode(&sent).unwrap();
/// assert_eq!(frame.iter().position(|byte| *byte == 0), Some(frame.len() - 1), "a zero ends a frame");
/// let mut receiver = Receiver::new();
/// let received: Vec<ToBoard> = frame.iter().filter_map(|byte| receiver.push(*byte)).collect();
/// assert_eq!(received, [sent]);
/// // A byte that changes on the way costs the frame.
/// frame[1] ^= 0x10;
/// assert!(frame.iter().all(|byte| receiver.push::<ToBoard>(*byte).is_none()));
/// assert_eq!(receiver.dropped().frames, 1);
/// ```
pub fn encode<M: Serialize>(message: &M) -> Result<Vec<u8, MAX_FRAME>, TooLong> {
    let mut buffer = [0u8; MAX_MESSAGE];
    let length = plain(message, &mut buffer)?;
    let mut frame = Vec::new();
    frame.resize(MAX_FRAME, 0).map_err(|_| TooLong)?;
    let stuffed = cobs::encode(&buffer[..length], &mut frame);
    frame.truncate(stuffed + 1);
    Ok(frame)
}

/// Fills a frame of fixed length, for buses that clock out as much as they clock in: the message, zeros, and the CRC over
/// all of that.
///
/// ```
/// use link::framing::{sealed, unsealed};
/// use link::messages::Command;
///
/// let sent = Command { tick: 7, drive_torque: 0.5, load_torque: 0.0 };
/// let mut frame = [0; 32];
/// sealed(&sent, &mut frame).unwrap();
/// assert_eq!(unsealed(&frame), Some(sent));
/// frame[3] ^= 1;
/// assert_eq!(unsealed::<Command>(&frame), None);
/// ```
pub fn sealed<M: Serialize>(message: &M, frame: &mut [u8]) -> Result<(), TooLong> {
    let (content, seal) = frame.split_last_chunk_mut::<CRC_BYTES>().ok_or(TooLong)?;
    let used = postcard::to_slice(message, content).map_err(|_| TooLong)?.len();
    content.iter_mut().skip(used).for_each(|byte| *byte = 0);
    *seal = CRC.checksum(content).to_le_bytes();
    Ok(())
}

/// Whether a message stands in the shortest form that there is: a number filled up with zero bits is a second way to say the
/// same, which no sender of ours takes. Compares byte by byte with what a sender would have written, without a buffer.
fn is_shortest<M: Serialize>(message: &M, received: &[u8]) -> bool {
    matches!(postcard::serialize_with_flavor(message, Comparison(received)), Ok([]))
}

/// Takes what a sender would write as long as it is what was received; what was received beyond that is left.
struct Comparison<'r>(&'r [u8]);

impl<'r> Flavor for Comparison<'r> {
    type Output = &'r [u8];

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        match self.0.split_first() {
            Some((received, rest)) if *received == byte => {
                self.0 = rest;
                Ok(())
            }
            _ => Err(postcard::Error::SerializeBufferFull),
        }
    }

    fn finalize(self) -> postcard::Result<Self::Output> {
        Ok(self.0)
    }
}

/// The message in a frame of fixed length, if it came through unchanged and stands in the one form that [`sealed`] gives it.
pub fn unsealed<M: Serialize + DeserializeOwned>(frame: &[u8]) -> Option<M> {
    let (message, plain, rest) = unchanged::<M>(frame)?;
    (is_shortest(&message, plain) && rest.iter().all(|byte| *byte == 0)).then_some(message)
}

/// The same without a look at the form, which costs as much as writing the message anew: for who answers within a tick.
pub fn unsealed_within_a_tick<M: DeserializeOwned>(frame: &[u8]) -> Option<M> {
    unchanged(frame).map(|(message, _, _)| message)
}

/// The message in a frame that came through unchanged, its bytes, and those that fill the frame up.
fn unchanged<M: DeserializeOwned>(frame: &[u8]) -> Option<(M, &[u8], &[u8])> {
    let (content, seal) = frame.split_last_chunk::<CRC_BYTES>()?;
    let good = CRC.checksum(content).to_le_bytes() == *seal;
    let (message, rest) = postcard::take_from_bytes(content).ok().filter(|_| good)?;
    let (plain, _) = content.split_at_checked(content.len().checked_sub(rest.len())?)?;
    Some((message, plain, rest))
}

/// What a [`Receiver`] has thrown away.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Frames with a bad CRC, a bad length, an unknown content or one that is not in its shortest form.
    pub frames: u32,
}

/// Puts frames together from bytes in any portions.
#[derive(Debug, Clone)]
pub struct Receiver {
    buffer: Vec<u8, MAX_FRAME>,
    overflowed: bool,
    dropped: Dropped,
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

impl Receiver {
    /// Waits for the first frame.
    pub const fn new() -> Self {
        Self { buffer: Vec::new(), overflowed: false, dropped: Dropped { frames: 0 } }
    }

    /// Takes one byte; returns a message if the byte ended a good frame. Empty frames are fill, not errors.
    pub fn push<M: Serialize + DeserializeOwned>(&mut self, byte: u8) -> Option<M> {
        self.take(byte, is_shortest)
    }

    /// The same for a message of which only the beginning is known, and which therefore cannot be held against what a sender
    /// would have written.
    pub fn push_beginning<M: DeserializeOwned>(&mut self, byte: u8) -> Option<M> {
        self.take(byte, |_, _| true)
    }

    fn take<M: DeserializeOwned>(&mut self, byte: u8, good: impl Fn(&M, &[u8]) -> bool) -> Option<M> {
        if byte != 0 {
            self.overflowed |= self.buffer.push(byte).is_err();
            return None;
        }
        let empty = self.buffer.is_empty();
        let message = if self.overflowed { None } else { decode(&mut self.buffer, good) };
        if message.is_none() && !empty {
            self.dropped.frames = self.dropped.frames.saturating_add(1);
        }
        self.buffer.clear();
        self.overflowed = false;
        message
    }

    /// What was thrown away so far.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Forgets a half frame and the counts.
    pub fn clear(&mut self) {
        *self = Self::new();
    }
}

fn decode<M: DeserializeOwned>(stuffed: &mut [u8], good: impl Fn(&M, &[u8]) -> bool) -> Option<M> {
    let length = cobs::decode_in_place(stuffed).ok()?;
    let (plain, checksum) = stuffed.get(..length)?.split_at_checked(length.checked_sub(CRC_BYTES)?)?;
    if checksum != CRC.checksum(plain).to_le_bytes() {
        return None;
    }
    match postcard::take_from_bytes(plain) {
        Ok((message, [])) if good(&message, plain) => Some(message),
        _ => None,
    }
}

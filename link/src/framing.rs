//! Framing of messages on a byte stream: postcard, CRC-32 (ISO-HDLC, little-endian), COBS, a zero byte. A receiver that
//! starts in mid-frame or meets garbage synchronises at the next zero byte; it counts dropped frames.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use heapless::Vec;
use postcard::ser_flavors::Flavor;
use serde::{Serialize, de::DeserializeOwned};

/// Longest message before stuffing, CRC included.
pub const MAX_MESSAGE: usize = 512;
/// Longest frame on the wire: COBS adds one byte per 254 and one more, then the closing zero follows.
pub const MAX_FRAME: usize = MAX_MESSAGE + MAX_MESSAGE / 254 + 3;

pub(crate) const CRC_BYTES: usize = 4;
pub(crate) static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);
/// CRC over an unchanged message including its CRC.
pub(crate) const UNCHANGED: u32 = CRC_32_ISO_HDLC.residue ^ CRC_32_ISO_HDLC.xorout;

/// Error of a message longer than [`MAX_MESSAGE`] bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLong;

/// Writes a message with its checksum to the start of a buffer; returns their length.
fn plain<M: Serialize>(message: &M, buffer: &mut [u8]) -> Result<usize, TooLong> {
    let room = buffer.len().checked_sub(CRC_BYTES).ok_or(TooLong)?;
    let length = postcard::to_slice(message, buffer.get_mut(..room).ok_or(TooLong)?).map_err(|_| TooLong)?.len();
    let checksum = CRC.checksum(buffer.get(..length).ok_or(TooLong)?);
    let place = buffer.get_mut(length..length + CRC_BYTES).ok_or(TooLong)?;
    place.copy_from_slice(&checksum.to_le_bytes());
    Ok(length + CRC_BYTES)
}

/// Encodes a message as a frame.
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

/// Fills a frame of fixed length, for buses that send as many bytes as they receive: message, zeros, and the CRC over
/// both.
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

/// Returns `true` if a message has its shortest encoding, as every sender writes it: a number padded with zero bits is
/// a longer encoding of an equal value. Compares byte by byte with the re-encoded message, without a buffer.
fn is_shortest<M: Serialize>(message: &M, received: &[u8]) -> bool {
    matches!(postcard::serialize_with_flavor(message, Comparison(received)), Ok([]))
}

/// Sink that accepts bytes equal to the received ones; [`Flavor::finalize`] returns the surplus received bytes.
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

/// Decodes a frame of fixed length; `None` unless the frame is unchanged and has exactly the form of [`sealed`].
pub fn unsealed<M: Serialize + DeserializeOwned>(frame: &[u8]) -> Option<M> {
    let (message, plain, rest) = unchanged::<M>(frame)?;
    (is_shortest(&message, plain) && rest.iter().all(|byte| *byte == 0)).then_some(message)
}

/// Decodes a frame of fixed length like [`unsealed`], but without checking that the encoding is the shortest: that
/// check takes as long as encoding the message, too long for receivers that answer within a tick.
pub fn unsealed_within_a_tick<M: DeserializeOwned>(frame: &[u8]) -> Option<M> {
    unchanged(frame).map(|(message, _, _)| message)
}

/// Decodes an unchanged frame of fixed length: message, its bytes, padding.
fn unchanged<M: DeserializeOwned>(frame: &[u8]) -> Option<(M, &[u8], &[u8])> {
    let (content, seal) = frame.split_last_chunk::<CRC_BYTES>()?;
    let good = CRC.checksum(content).to_le_bytes() == *seal;
    let (message, rest) = postcard::take_from_bytes(content).ok().filter(|_| good)?;
    let (plain, _) = content.split_at_checked(content.len().checked_sub(rest.len())?)?;
    Some((message, plain, rest))
}

/// Counts of frames dropped by a [`Receiver`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Frames with a bad CRC, a bad length, an unknown content or a longer encoding than necessary.
    pub frames: u32,
}

/// Assembles frames from single bytes.
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
    /// Receiver that waits for the first frame.
    pub const fn new() -> Self {
        Self { buffer: Vec::new(), overflowed: false, dropped: Dropped { frames: 0 } }
    }

    /// Takes one byte; returns a message if the byte ended a good frame. Empty frames are padding, not errors.
    pub fn push<M: Serialize + DeserializeOwned>(&mut self, byte: u8) -> Option<M> {
        self.take(byte, is_shortest)
    }

    /// Takes one byte as [`Receiver::push`] does, for a type that knows only the beginning of a message; without the
    /// check for the shortest encoding, which needs the whole message.
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

    /// Counts of dropped frames so far.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Discards an incomplete frame and clears the counts.
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

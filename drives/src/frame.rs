//! CAN frames: classical and CAN FD.

pub use embedded_can::{ExtendedId, Id, StandardId};

/// Most data bytes of a CAN FD frame.
pub const MAX_DATA: usize = 64;

/// Data lengths by length code (DLC).
pub const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, MAX_DATA];

/// Kind of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Classical frame with up to 8 data bytes.
    Classic,
    /// Classical request for a frame of this identifier; the length is that of the wanted frame.
    Remote,
    /// CAN FD frame with up to 64 data bytes; true for data at the second bit rate.
    Flexible(bool),
}

/// CAN frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Identifier of 11 or 29 bits.
    pub id: Id,
    /// Kind.
    pub kind: Kind,
    length: u8,
    data: [u8; MAX_DATA],
}

impl Frame {
    /// Classical data frame; `None` for more than 8 bytes.
    pub fn classic(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        Self::with_kind(id.into(), Kind::Classic, data)
    }

    /// CAN FD frame with bit rate switch. Data is padded with `padding` to the next length that CAN FD has; `None` for
    /// more than 64 bytes.
    pub fn flexible(id: impl Into<Id>, data: &[u8], padding: u8) -> Option<Self> {
        let mut frame = Self::with_kind(id.into(), Kind::Flexible(true), data)?;
        let padded = flexible_length(data.len());
        frame.data.get_mut(data.len()..padded)?.fill(padding);
        frame.length = padded as u8;
        Some(frame)
    }

    /// Frame of any kind; `None` if the kind has no frame of this length.
    pub fn with_kind(id: Id, kind: Kind, data: &[u8]) -> Option<Self> {
        let fits = match kind {
            Kind::Classic => data.len() <= 8,
            Kind::Remote => false,
            Kind::Flexible(_) => data.len() <= MAX_DATA,
        };
        let mut frame = Self { id, kind, length: data.len() as u8, data: [0; MAX_DATA] };
        frame.data.get_mut(..data.len())?.copy_from_slice(data);
        fits.then_some(frame)
    }

    /// Classical request for a frame of up to 8 bytes; `None` for more.
    pub fn remote(id: impl Into<Id>, length: u8) -> Option<Self> {
        (length <= 8).then(|| Self { id: id.into(), kind: Kind::Remote, length, data: [0; MAX_DATA] })
    }

    /// Data; empty for a remote frame.
    pub fn data(&self) -> &[u8] {
        if self.kind == Kind::Remote { &[] } else { self.data.get(..self.length()).unwrap_or_default() }
    }

    /// Data of a frame with exactly `N` bytes, or the first `N` of a longer one.
    pub fn bytes<const N: usize>(&self) -> Option<[u8; N]> {
        self.data().first_chunk().copied()
    }

    /// Number of data bytes, also of a remote frame's answer.
    pub fn length(&self) -> usize {
        usize::from(self.length)
    }

    /// Identifier as a number, without its kind.
    pub fn raw_id(&self) -> u32 {
        match self.id {
            Id::Standard(id) => id.as_raw().into(),
            Id::Extended(id) => id.as_raw(),
        }
    }

    /// Identifier of an 11-bit frame.
    pub fn standard_id(&self) -> Option<u16> {
        match self.id {
            Id::Standard(id) => Some(id.as_raw()),
            Id::Extended(_) => None,
        }
    }

    /// Identifier of a 29-bit frame.
    pub fn extended_id(&self) -> Option<u32> {
        match self.id {
            Id::Standard(_) => None,
            Id::Extended(id) => Some(id.as_raw()),
        }
    }
}

/// Receiver of the frames that a drive sends.
pub type Send<'s> = &'s mut dyn FnMut(Frame);

/// Identifier of 11 bits; higher bits are cut off.
pub fn standard(id: u16) -> Id {
    StandardId::new(id & StandardId::MAX.as_raw()).unwrap_or(StandardId::ZERO).into()
}

/// Identifier of 29 bits; higher bits are cut off.
pub fn extended(id: u32) -> Id {
    ExtendedId::new(id & ExtendedId::MAX.as_raw()).unwrap_or(ExtendedId::ZERO).into()
}

/// Length code (DLC) of the shortest frame with room for `length` bytes.
pub fn length_code(length: usize) -> u32 {
    LENGTHS.iter().position(|long| *long >= length).unwrap_or(LENGTHS.len() - 1) as u32
}

/// Least length of a CAN FD frame with room for `length` bytes.
pub fn flexible_length(length: usize) -> usize {
    LENGTHS.into_iter().find(|long| *long >= length).unwrap_or(MAX_DATA)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flexible_frame_is_padded() {
        let frame = Frame::flexible(extended(0x8001), &[1; 9], 0x50).unwrap();
        assert_eq!(frame.length(), 12);
        assert_eq!(frame.data()[9..], [0x50; 3]);
        assert_eq!(Frame::flexible(standard(1), &[0; 65], 0), None);
    }

    #[test]
    fn classical_frame_has_eight_bytes_at_most() {
        assert_eq!(Frame::classic(standard(1), &[0; 9]), None);
        assert_eq!(Frame::classic(standard(0x812), &[1, 2]).unwrap().raw_id(), 0x12);
        assert_eq!(Frame::remote(standard(1), 8).unwrap().data(), []);
    }
}

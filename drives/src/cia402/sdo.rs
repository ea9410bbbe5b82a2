//! Service data objects: the frames of both directions, and the server's transfers.
//!
//! | bits of byte 0 | initiate with data | initiate without data | segment | segment without data | abort |
//! |---|---|---|---|---|---|
//! | 7 to 5, request | 1 | 2 | 0 | 3 | 4 |
//! | 7 to 5, response | 2 | 3 | 0 | 1 | 4 |
//! | others | 3..2 unused bytes, 1 expedited, 0 size | | 4 toggle, 3..1 unused bytes, 0 last | 4 toggle | |

use super::dictionary::Address;
use heapless::Vec;

/// Data of a segment.
pub type Segment = Vec<u8, 7>;

/// Reason of an aborted transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Abort {
    /// Toggle bit did not alternate.
    Toggle = 0x0503_0000,
    /// Unknown command.
    Command = 0x0504_0001,
    /// Access that is not possible now.
    Unsupported = 0x0601_0000,
    /// Write to a read-only object.
    ReadOnly = 0x0601_0002,
    /// No such object.
    NoObject = 0x0602_0000,
    /// Object that a PDO cannot hold.
    NotMappable = 0x0604_0041,
    /// Mapping longer than a PDO.
    MappingTooLong = 0x0604_0042,
    /// Data longer than the object.
    TooLong = 0x0607_0012,
    /// Data shorter than the object.
    TooShort = 0x0607_0013,
    /// No such sub-index.
    NoSubIndex = 0x0609_0011,
    /// Value that the object does not take.
    Range = 0x0609_0030,
    /// Value above the range.
    TooHigh = 0x0609_0031,
    /// Value below the range.
    TooLow = 0x0609_0032,
    /// Not possible in the present state of the drive.
    State = 0x0800_0022,
    /// No value at present.
    NoData = 0x0800_0024,
}

/// Content of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sdo {
    /// Initiate with up to 4 bytes; the size may be left open.
    Expedited {
        /// Object.
        address: Address,
        /// Data, behind its size zero.
        data: [u8; 4],
        /// Bytes of data.
        size: Option<usize>,
    },
    /// Initiate of a segmented transfer.
    Long {
        /// Object.
        address: Address,
        /// Bytes of all segments.
        size: Option<u32>,
    },
    /// Initiate without data: request of an upload, answer to a download.
    Empty {
        /// Object.
        address: Address,
    },
    /// Segment.
    Segment {
        /// Toggle bit.
        toggle: bool,
        /// Data.
        data: Segment,
        /// True for the last segment.
        is_last: bool,
    },
    /// Segment without data: request of a segment, answer to a segment.
    Next {
        /// Toggle bit.
        toggle: bool,
    },
    /// End of a transfer without success.
    Abort {
        /// Object.
        address: Address,
        /// Reason, an [`Abort`] or a code of another maker.
        code: u32,
    },
}

/// Direction of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// From the client to the drive.
    Request,
    /// From the drive to the client.
    Response,
}

/// Content of a frame without its direction.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Specifier {
    Data,
    Empty,
    Segment,
    Next,
    Abort,
}

impl Specifier {
    const ALL: [Self; 5] = [Self::Data, Self::Empty, Self::Segment, Self::Next, Self::Abort];

    const fn code(self, side: Side) -> u8 {
        match (self, side) {
            (Self::Data, Side::Request) => 1,
            (Self::Data, Side::Response) => 2,
            (Self::Empty, Side::Request) => 2,
            (Self::Empty, Side::Response) => 3,
            (Self::Segment, _) => 0,
            (Self::Next, Side::Request) => 3,
            (Self::Next, Side::Response) => 1,
            (Self::Abort, _) => 4,
        }
    }
}

/// Address in bytes 1 to 3.
pub(super) fn address_of(bytes: &[u8; 8]) -> Address {
    Address::new(u16::from_le_bytes([bytes[1], bytes[2]]), bytes[3])
}

impl Sdo {
    /// Expedited transfer of up to 4 bytes.
    pub fn expedited(address: Address, raw: u32, size: usize) -> Self {
        let mut data = raw.to_le_bytes();
        data.iter_mut().skip(size).for_each(|byte| *byte = 0);
        Self::Expedited { address, data, size: Some(size) }
    }

    /// Bytes of the frame.
    pub fn encode(&self, side: Side) -> [u8; 8] {
        let (specifier, flags) = match self {
            Self::Expedited { size: Some(size), .. } => {
                (Specifier::Data, (4_usize.saturating_sub(*size) as u8) << 2 | 0b11)
            }
            Self::Expedited { size: None, .. } => (Specifier::Data, 0b10),
            Self::Long { size, .. } => (Specifier::Data, u8::from(size.is_some())),
            Self::Empty { .. } => (Specifier::Empty, 0),
            Self::Segment { toggle, data, is_last } => {
                let unused = 7_usize.saturating_sub(data.len()) as u8;
                (Specifier::Segment, u8::from(*toggle) << 4 | unused << 1 | u8::from(*is_last))
            }
            Self::Next { toggle } => (Specifier::Next, u8::from(*toggle) << 4),
            Self::Abort { .. } => (Specifier::Abort, 0),
        };
        let (address, data) = match self {
            Self::Expedited { address, data, .. } => (*address, *data),
            Self::Long { address, size } => (*address, size.unwrap_or(0).to_le_bytes()),
            Self::Empty { address } => (*address, [0; 4]),
            Self::Abort { address, code } => (*address, code.to_le_bytes()),
            Self::Segment { .. } | Self::Next { .. } => (Address::new(0, 0), [0; 4]),
        };
        let [low, high] = address.index.to_le_bytes();
        let mut bytes = [specifier.code(side) << 5 | flags, low, high, address.sub, data[0], data[1], data[2], data[3]];
        if let Self::Segment { data, .. } = self {
            bytes.iter_mut().skip(1).zip(data).for_each(|(byte, data)| *byte = *data);
        }
        bytes
    }

    /// Content of a frame; `None` for another command, as of a block transfer.
    pub fn decode(side: Side, bytes: &[u8; 8]) -> Option<Self> {
        let first = bytes[0];
        let specifier = Specifier::ALL.into_iter().find(|specifier| specifier.code(side) == first >> 5)?;
        let address = address_of(bytes);
        let data = [bytes[4], bytes[5], bytes[6], bytes[7]];
        let toggle = first & 0x10 != 0;
        Some(match specifier {
            Specifier::Data if first & 2 != 0 => {
                let size = (first & 1 != 0).then_some(4 - usize::from(first >> 2 & 3));
                Self::Expedited { address, data, size }
            }
            Specifier::Data => Self::Long { address, size: (first & 1 != 0).then_some(u32::from_le_bytes(data)) },
            Specifier::Empty => Self::Empty { address },
            Specifier::Segment => {
                let data = bytes.iter().skip(1).take(7 - usize::from(first >> 1 & 7)).copied().collect();
                Self::Segment { toggle, data, is_last: first & 1 != 0 }
            }
            Specifier::Next => Self::Next { toggle },
            Specifier::Abort => Self::Abort { address, code: u32::from_le_bytes(data) },
        })
    }
}

/// Value of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Value {
    Raw(u32, usize),
    Text(&'static str),
}

/// Objects that the transfers read and write.
pub(super) trait Objects {
    fn read(&self, address: Address) -> Result<Value, Abort>;

    /// Writes up to 4 bytes; without a size the object's is taken.
    fn write(&mut self, address: Address, data: [u8; 4], size: Option<usize>) -> Result<(), Abort>;
}

/// Transfer of the server.
#[derive(Debug, Clone, Default)]
pub(super) enum Transfer {
    /// None.
    #[default]
    Idle,
    /// Upload of a text.
    Upload { address: Address, rest: &'static str, toggle: bool },
    /// Download of a number.
    Download { address: Address, data: Vec<u8, 4>, toggle: bool },
}

impl Transfer {
    /// Answer to a frame of the client; `None` after the client's abort.
    pub fn answer(&mut self, bytes: &[u8; 8], objects: &mut impl Objects) -> Option<Sdo> {
        let address = match self {
            Self::Upload { address, .. } | Self::Download { address, .. } => *address,
            Self::Idle => address_of(bytes),
        };
        let (address, answer) = match Sdo::decode(Side::Request, bytes) {
            Some(Sdo::Abort { .. }) => {
                *self = Self::Idle;
                return None;
            }
            Some(Sdo::Empty { address }) => (address, self.begin_upload(address, objects)),
            Some(Sdo::Expedited { address, data, size }) => {
                *self = Self::Idle;
                (address, objects.write(address, data, size).map(|()| Sdo::Empty { address }))
            }
            Some(Sdo::Long { address, size }) => (address, self.begin_download(address, size, objects)),
            Some(Sdo::Next { toggle }) => (address, self.upload_segment(toggle)),
            Some(Sdo::Segment { toggle, data, is_last }) => {
                (address, self.download_segment(toggle, &data, is_last, objects))
            }
            None => (address_of(bytes), Err(Abort::Command)),
        };
        Some(answer.unwrap_or_else(|abort| {
            *self = Self::Idle;
            Sdo::Abort { address, code: abort as u32 }
        }))
    }

    fn begin_upload(&mut self, address: Address, objects: &impl Objects) -> Result<Sdo, Abort> {
        *self = Self::Idle;
        Ok(match objects.read(address)? {
            Value::Raw(raw, size) => Sdo::expedited(address, raw, size),
            Value::Text(text) => {
                *self = Self::Upload { address, rest: text, toggle: false };
                Sdo::Long { address, size: Some(text.len() as u32) }
            }
        })
    }

    fn upload_segment(&mut self, wanted: bool) -> Result<Sdo, Abort> {
        let Self::Upload { rest, toggle, .. } = self else { return Err(Abort::Command) };
        if wanted != *toggle {
            return Err(Abort::Toggle);
        }
        let data: Segment = rest.bytes().take(7).collect();
        *rest = rest.get(data.len()..).unwrap_or_default();
        *toggle = !*toggle;
        let is_last = rest.is_empty();
        if is_last {
            *self = Self::Idle;
        }
        Ok(Sdo::Segment { toggle: wanted, data, is_last })
    }

    fn begin_download(&mut self, address: Address, size: Option<u32>, objects: &impl Objects) -> Result<Sdo, Abort> {
        *self = Self::Idle;
        // An object that does not exist is refused at once; all others when they are written.
        match objects.read(address) {
            Ok(Value::Text(_)) => return Err(Abort::ReadOnly),
            Ok(Value::Raw(_, most)) if size.is_some_and(|size| size > most as u32) => return Err(Abort::TooLong),
            Err(abort @ (Abort::NoObject | Abort::NoSubIndex)) => return Err(abort),
            _ => {}
        }
        *self = Self::Download { address, data: Vec::new(), toggle: false };
        Ok(Sdo::Empty { address })
    }

    fn download_segment(
        &mut self,
        sent: bool,
        segment: &Segment,
        is_last: bool,
        objects: &mut impl Objects,
    ) -> Result<Sdo, Abort> {
        let Self::Download { address, data, toggle } = self else { return Err(Abort::Command) };
        if sent != *toggle {
            return Err(Abort::Toggle);
        }
        data.extend_from_slice(segment).map_err(|_| Abort::TooLong)?;
        *toggle = !*toggle;
        if is_last {
            let mut bytes = [0; 4];
            bytes.iter_mut().zip(data.iter()).for_each(|(to, from)| *to = *from);
            let (address, size) = (*address, data.len());
            *self = Self::Idle;
            objects.write(address, bytes, Some(size))?;
        }
        Ok(Sdo::Next { toggle: sent })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ADDRESS: Address = Address::new(0x6083, 0);

    #[test]
    fn frames_are_those_of_canopen() {
        // Requests of canopen 2.4.1: sdo[0x6083].raw = 720000; sdo[0x1008].raw; abort(0x05040000).
        let write = Sdo::expedited(ADDRESS, 720_000, 4);
        assert_eq!(write.encode(Side::Request), [0x23, 0x83, 0x60, 0, 0x80, 0xFC, 0x0A, 0]);
        let read = Sdo::Empty { address: Address::new(0x1008, 0) };
        assert_eq!(read.encode(Side::Request), [0x40, 0x08, 0x10, 0, 0, 0, 0, 0]);
        let abort = Sdo::Abort { address: Address::new(0, 0), code: 0x0504_0000 };
        assert_eq!(abort.encode(Side::Request), [0x80, 0, 0, 0, 0, 0, 0x04, 0x05]);
        // Answers that canopen decodes: one byte; segments of a text.
        assert_eq!(Sdo::expedited(ADDRESS, 0xFF12, 1).encode(Side::Response), [0x4F, 0x83, 0x60, 0, 0x12, 0, 0, 0]);
        let last = Sdo::Segment { toggle: true, data: Vec::from_slice(b"ab").unwrap(), is_last: true };
        assert_eq!(last.encode(Side::Response), [0x1B, b'a', b'b', 0, 0, 0, 0, 0]);
    }

    #[test]
    fn block_transfer_is_no_command() {
        assert_eq!(Sdo::decode(Side::Request, &[0xA4, 0, 0, 0, 0, 0, 0, 0]), None);
        assert_eq!(Sdo::decode(Side::Response, &[0xC2, 0, 0, 0, 0, 0, 0, 0]), None);
    }

    proptest! {
        #[test]
        fn frames_come_back(bytes: [u8; 8], is_request: bool) {
            let side = if is_request { Side::Request } else { Side::Response };
            if let Some(sdo) = Sdo::decode(side, &bytes) {
                prop_assert_eq!(Sdo::decode(side, &sdo.encode(side)), Some(sdo));
            }
        }
    }
}

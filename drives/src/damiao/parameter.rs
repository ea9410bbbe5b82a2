//! Parameter frames: access to registers, storing, and the request for feedback. A request and its answer have the same
//! layout: requests go to identifier 0x7FF, answers to the feedback identifier of the drive.
//!
//! | byte | contents |
//! |---|---|
//! | 0, 1 | identifier of the drive, low byte first |
//! | 2 | 0x33 read, 0x55 write, 0xAA store, 0xCC feedback |
//! | 3 | address of the register; 1 to store; 0 for feedback |
//! | 4 to 7 | value, low byte first: f32 or u32 |

/// Identifier of all requests.
pub const ID: u16 = 0x7FF;
/// Byte 3 of the order to store.
pub const STORE_ALL: u8 = 1;

/// Purpose of a parameter frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Reads a register.
    Read,
    /// Writes a register.
    Write,
    /// Stores all registers.
    Store,
    /// Requests a feedback frame.
    Refresh,
}

impl Purpose {
    const ALL: [Self; 4] = [Self::Read, Self::Write, Self::Store, Self::Refresh];

    /// Byte 2.
    fn code(self) -> u8 {
        match self {
            Self::Read => 0x33,
            Self::Write => 0x55,
            Self::Store => 0xAA,
            Self::Refresh => 0xCC,
        }
    }
}

/// Parameter frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parameter {
    /// Identifier of the drive.
    pub id: u16,
    /// Purpose.
    pub purpose: Purpose,
    /// Address of the register.
    pub address: u8,
    /// Value of the register.
    pub value: [u8; 4],
}

impl Parameter {
    /// Data of the frame.
    pub fn encode(&self) -> [u8; 8] {
        let [low, high] = self.id.to_le_bytes();
        let [a, b, c, d] = self.value;
        [low, high, self.purpose.code(), self.address, a, b, c, d]
    }

    /// Frame of its data. The value may be missing, except in order to write.
    pub fn decode(data: &[u8]) -> Option<Self> {
        let [low, high, code, address] = *data.first_chunk()?;
        let purpose = Purpose::ALL.into_iter().find(|purpose| purpose.code() == code)?;
        let value = data.get(4..).and_then(|rest| rest.first_chunk().copied());
        let value = if purpose == Purpose::Write { value? } else { value.unwrap_or_default() };
        Some(Self { id: u16::from_le_bytes([low, high]), purpose, address, value })
    }
}

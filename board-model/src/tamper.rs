//! Mistakes planted into the writes of an image: each is as if a line of the firmware were another one. The checks must find
//! them.

/// What becomes of a write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// It is left out.
    Omit,
    /// It is left out if it writes this.
    OmitValue(u32),
    /// These bits are not set.
    Clear(u32),
    /// These bits are set.
    Set(u32),
    /// The field of this mask has this value instead.
    Field(u32, u32),
    /// The field of this mask has the second value wherever it has the first.
    Swap(u32, u32, u32),
}

/// A mistake at a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tamper {
    /// The register's address.
    pub address: u32,
    /// What becomes of writes to it.
    pub how: How,
}

impl Tamper {
    /// The value that is written instead, if any is.
    pub fn apply(self, address: u32, value: u32) -> Option<u32> {
        if address != self.address {
            return Some(value);
        }
        match self.how {
            How::Omit => None,
            How::OmitValue(omitted) => (value != omitted).then_some(value),
            How::Clear(bits) => Some(value & !bits),
            How::Set(bits) => Some(value | bits),
            How::Field(mask, field) => Some(value & !mask | field),
            How::Swap(mask, from, to) if value & mask == from => Some(value & !mask | to),
            How::Swap(..) => Some(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_register_that_is_meant_is_changed() {
        let tamper = Tamper { address: 8, how: How::Swap(0xf0, 0x20, 0x30) };
        assert_eq!(
            [(8, 0x21), (8, 0x11), (4, 0x21)].map(|(at, value)| tamper.apply(at, value)),
            [Some(0x31), Some(0x11), Some(0x21)]
        );
        assert_eq!(Tamper { address: 8, how: How::OmitValue(1) }.apply(8, 1), None);
    }
}

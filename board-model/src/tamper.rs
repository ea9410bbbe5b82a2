//! Mistakes planted into the writes of an image, each equivalent to a wrong line of the firmware. The checks must find
//! them.

/// Change to a write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// Omits the write.
    Omit,
    /// Omits the write of this value.
    OmitValue(u32),
    /// Clears these bits.
    Clear(u32),
    /// Sets these bits.
    Set(u32),
    /// Replaces the field of this mask by a value.
    Field(u32, u32),
    /// Replaces the field of this mask by the second value if it has the first.
    Swap(u32, u32, u32),
}

/// Change to the writes of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tamper {
    /// Address of the register.
    pub address: u32,
    /// Change to the writes.
    pub how: How,
}

impl Tamper {
    /// Value that is written instead, or `None` if the write is omitted.
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
    fn only_selected_register_changed() {
        let tamper = Tamper { address: 8, how: How::Swap(0xf0, 0x20, 0x30) };
        assert_eq!(
            [(8, 0x21), (8, 0x11), (4, 0x21)].map(|(at, value)| tamper.apply(at, value)),
            [Some(0x31), Some(0x11), Some(0x21)]
        );
        assert_eq!(Tamper { address: 8, how: How::OmitValue(1) }.apply(8, 1), None);
    }
}

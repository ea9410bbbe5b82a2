//! Values of parameters and registers, in four bytes on the wire, low byte first.

/// Kind of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Truth value.
    Bool,
    /// Whole number of 8 bits.
    U8,
    /// Whole number of 16 bits with a sign.
    I16,
    /// Whole number of 16 bits.
    U16,
    /// Whole number of 32 bits.
    U32,
    /// Number with a fraction.
    F32,
}

/// Value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// Truth value.
    Bool(bool),
    /// Whole number of 8 bits.
    U8(u8),
    /// Whole number of 16 bits with a sign.
    I16(i16),
    /// Whole number of 16 bits.
    U16(u16),
    /// Whole number of 32 bits.
    U32(u32),
    /// Number with a fraction.
    F32(f32),
}

impl Value {
    /// Bytes of the value, filled up with zeros.
    pub fn to_bytes(self) -> [u8; 4] {
        let word = match self {
            Self::Bool(value) => value.into(),
            Self::U8(value) => value.into(),
            Self::I16(value) => value.cast_unsigned().into(),
            Self::U16(value) => value.into(),
            Self::U32(value) => value,
            Self::F32(value) => value.to_bits(),
        };
        word.to_le_bytes()
    }

    /// Value of four bytes.
    pub fn from_bytes(kind: Kind, bytes: [u8; 4]) -> Self {
        let word = u32::from_le_bytes(bytes);
        match kind {
            Kind::Bool => Self::Bool(word as u8 != 0),
            Kind::U8 => Self::U8(word as u8),
            Kind::I16 => Self::I16((word as u16).cast_signed()),
            Kind::U16 => Self::U16(word as u16),
            Kind::U32 => Self::U32(word),
            Kind::F32 => Self::F32(f32::from_bits(word)),
        }
    }

    /// Kind of the value.
    pub fn kind(self) -> Kind {
        match self {
            Self::Bool(_) => Kind::Bool,
            Self::U8(_) => Kind::U8,
            Self::I16(_) => Kind::I16,
            Self::U16(_) => Kind::U16,
            Self::U32(_) => Kind::U32,
            Self::F32(_) => Kind::F32,
        }
    }

    /// Number, rounded to f32.
    pub fn to_f32(self) -> f32 {
        match self {
            Self::Bool(value) => f32::from(u8::from(value)),
            Self::U8(value) => value.into(),
            Self::I16(value) => value.into(),
            Self::U16(value) => value.into(),
            Self::U32(value) => value as f32,
            Self::F32(value) => value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_round_trip() {
        let values = [
            (Value::Bool(true), [1, 0, 0, 0]),
            (Value::U8(0x80), [0x80, 0, 0, 0]),
            (Value::I16(-2), [0xFE, 0xFF, 0, 0]),
            (Value::U16(0x1234), [0x34, 0x12, 0, 0]),
            (Value::U32(0x0102_0304), [4, 3, 2, 1]),
            (Value::F32(1.0), [0, 0, 0x80, 0x3F]),
        ];
        for (value, bytes) in values {
            assert_eq!(value.to_bytes(), bytes);
            assert_eq!(Value::from_bytes(value.kind(), bytes), value);
        }
        assert_eq!(Value::from_bytes(Kind::Bool, [2, 0, 0, 0]), Value::Bool(true));
        assert_eq!(Value::I16(-2).to_f32(), -2.0);
    }
}

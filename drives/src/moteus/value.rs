//! Values of registers on the wire: four resolutions, and the unit of each physical quantity.

/// Number type of a value on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resolution {
    /// 8-bit integer.
    Int8,
    /// 16-bit integer.
    Int16,
    /// 32-bit integer.
    Int32,
    /// 32-bit float.
    Float,
}

impl Resolution {
    /// Resolution by its code of two bits.
    pub fn from_code(code: u8) -> Self {
        match code & 3 {
            0 => Self::Int8,
            1 => Self::Int16,
            2 => Self::Int32,
            _ => Self::Float,
        }
    }

    /// Code of two bits.
    pub fn code(self) -> u8 {
        self as u8
    }
}

/// Value on the wire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// 8-bit integer.
    Int8(i8),
    /// 16-bit integer.
    Int16(i16),
    /// 32-bit integer.
    Int32(i32),
    /// 32-bit float.
    Float(f32),
}

impl Value {
    /// Value of a register's content at a resolution.
    pub fn new(content: Content, scale: Scale, resolution: Resolution) -> Self {
        match content {
            Content::Integer(integer) => Self::from_integer(integer, resolution),
            Content::Number(number) => Self::from_number(number, scale, resolution),
        }
    }

    /// Integers keep their low bits, as the maker's firmware does.
    fn from_integer(integer: i32, resolution: Resolution) -> Self {
        match resolution {
            Resolution::Int8 => Self::Int8(integer as i8),
            Resolution::Int16 => Self::Int16(integer as i16),
            Resolution::Int32 => Self::Int32(integer),
            Resolution::Float => Self::Float(integer as f32),
        }
    }

    /// Numbers are cut toward zero and held within the type's range; the most negative integer stands for NaN and for
    /// an infinite number.
    fn from_number(number: f32, scale: Scale, resolution: Resolution) -> Self {
        let scaled = number / scale.unit(resolution);
        let is_number = number.is_finite();
        match resolution {
            Resolution::Int8 => Self::Int8(if is_number { (scaled as i8).max(-i8::MAX) } else { i8::MIN }),
            Resolution::Int16 => Self::Int16(if is_number { (scaled as i16).max(-i16::MAX) } else { i16::MIN }),
            Resolution::Int32 => Self::Int32(if is_number { (scaled as i32).max(-i32::MAX) } else { i32::MIN }),
            Resolution::Float => Self::Float(number),
        }
    }

    /// Resolution.
    pub fn resolution(self) -> Resolution {
        match self {
            Self::Int8(_) => Resolution::Int8,
            Self::Int16(_) => Resolution::Int16,
            Self::Int32(_) => Resolution::Int32,
            Self::Float(_) => Resolution::Float,
        }
    }

    /// Physical quantity; NaN for the most negative integer.
    pub fn number(self, scale: Scale) -> f32 {
        let integer = match self {
            Self::Int8(i8::MIN) | Self::Int16(i16::MIN) | Self::Int32(i32::MIN) => return f32::NAN,
            Self::Float(number) => return number,
            Self::Int8(integer) => f32::from(integer),
            Self::Int16(integer) => f32::from(integer),
            Self::Int32(integer) => integer as f32,
        };
        integer * scale.unit(self.resolution())
    }

    /// Value of an integer register.
    pub fn integer(self) -> i32 {
        match self {
            Self::Int8(integer) => integer.into(),
            Self::Int16(integer) => integer.into(),
            Self::Int32(integer) => integer,
            Self::Float(number) => number as i32,
        }
    }
}

/// Content of a register.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content {
    /// Physical quantity, in the unit of its [`Scale`].
    Number(f32),
    /// Code, bit field or counter.
    Integer(i32),
}

/// Physical quantity of a register, which decides the unit of its integers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Position [turns].
    Position,
    /// Speed [turns/s].
    Velocity,
    /// Acceleration [turns/s^2].
    Acceleration,
    /// Torque [N m].
    Torque,
    /// Current [A].
    Current,
    /// Voltage [V].
    Voltage,
    /// Temperature [deg C].
    Temperature,
    /// Time [s].
    Time,
    /// Power [W].
    Power,
    /// Share of a whole [-].
    Share,
    /// Integer of any resolution.
    Integer,
    /// Integer of 32 bits, at this resolution only.
    Word,
}

impl Scale {
    /// Unit of the least significant bit at a resolution.
    pub fn unit(self, resolution: Resolution) -> f32 {
        let (int8, int16, int32) = match self {
            Self::Position => (0.01, 0.0001, 0.00001),
            Self::Velocity => (0.1, 0.000_25, 0.00001),
            Self::Acceleration => (0.05, 0.001, 0.00001),
            Self::Torque => (0.5, 0.01, 0.001),
            Self::Current | Self::Temperature => (1.0, 0.1, 0.001),
            Self::Voltage => (0.5, 0.1, 0.001),
            Self::Time => (0.01, 0.001, 0.000_001),
            Self::Power => (10.0, 0.05, 0.0001),
            Self::Share => (1.0 / 127.0, 1.0 / 32_767.0, 1.0 / 2_147_483_647.0),
            Self::Integer | Self::Word => (1.0, 1.0, 1.0),
        };
        match resolution {
            Resolution::Int8 => int8,
            Resolution::Int16 => int16,
            Resolution::Int32 => int32,
            Resolution::Float => 1.0,
        }
    }

    /// True for registers that hold a physical quantity.
    pub fn is_number(self) -> bool {
        !matches!(self, Self::Integer | Self::Word)
    }
}

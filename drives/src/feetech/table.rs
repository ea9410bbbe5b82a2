//! Registers: address, width, sign, area, default, range and unit of each, as both ends of the bus use them.

/// Number of addresses.
pub const SIZE: usize = 112;

/// Steps in a turn of the output.
pub const STEPS: u32 = 4096;

/// Sign of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// No sign.
    Unsigned,
    /// Magnitude below a sign at this bit.
    Bit(u8),
    /// Two's complement of four bytes.
    Complement,
}

/// Area of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Area {
    /// Constant or measured; a write is ignored.
    ReadOnly,
    /// Kept over a power cycle if it is written while the lock is open.
    Saved,
    /// Lost at a power cycle.
    Volatile,
}

/// Register.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Address of the lowest byte.
    pub address: u8,
    /// Number of bytes, little endian.
    pub width: u8,
    /// Sign.
    pub sign: Sign,
    /// Area.
    pub area: Area,
    /// Value of the factory.
    pub default: i32,
    /// Least and largest value that can be written.
    pub range: (i32, i32),
    /// Quantity of a value of one, in the unit of the field's name.
    pub unit: f32,
}

impl Field {
    const fn new(area: Area, address: u8, width: u8, default: i32, range: (i32, i32)) -> Self {
        Self { address, width, sign: Sign::Unsigned, area, default, range, unit: 1.0 }
    }

    const fn saved(address: u8, width: u8, default: i32, low: i32, high: i32) -> Self {
        Self::new(Area::Saved, address, width, default, (low, high))
    }

    const fn volatile(address: u8, width: u8, default: i32, low: i32, high: i32) -> Self {
        Self::new(Area::Volatile, address, width, default, (low, high))
    }

    const fn read_only(address: u8, width: u8, default: i32) -> Self {
        Self::new(Area::ReadOnly, address, width, default, (i32::MIN, i32::MAX))
    }

    const fn signed(self, bit: u8) -> Self {
        Self { sign: Sign::Bit(bit), ..self }
    }

    const fn complement(self) -> Self {
        Self { sign: Sign::Complement, ..self }
    }

    const fn unit(self, unit: f32) -> Self {
        Self { unit, ..self }
    }

    /// Addresses.
    pub fn addresses(&self) -> core::ops::Range<usize> {
        usize::from(self.address)..usize::from(self.address) + usize::from(self.width)
    }

    /// Bytes of a value; those of the nearest value that the register can hold. Bytes beyond the width are zero.
    pub fn encode(&self, value: i32) -> [u8; 4] {
        let most = |bits: u32| i32::MAX >> (31 - bits.min(31));
        let field = match self.sign {
            Sign::Unsigned => value.clamp(0, most(8 * u32::from(self.width))),
            Sign::Bit(bit) => {
                let magnitude = value.saturating_abs().min(most(bit.into()));
                if value < 0 { magnitude | (1 << (bit & 31)) } else { magnitude }
            }
            Sign::Complement => value,
        };
        field.to_le_bytes()
    }

    /// Value of bytes; `None` with too few of them.
    pub fn decode(&self, bytes: &[u8]) -> Option<i32> {
        let bytes = bytes.get(..self.width.into())?;
        let field = bytes.iter().rev().fold(0_u32, |field, byte| field << 8 | u32::from(*byte)).cast_signed();
        Some(match self.sign {
            Sign::Unsigned | Sign::Complement => field,
            Sign::Bit(bit) => {
                let magnitude = field & !(i32::MAX << (bit & 31));
                if field >> (bit & 31) & 1 == 1 { -magnitude } else { magnitude }
            }
        })
    }

    /// Nearest value for a quantity.
    pub fn value_of(&self, quantity: f32) -> i32 {
        crate::scale::round(quantity / self.unit) as i32
    }

    /// Quantity of a value.
    pub fn quantity_of(&self, value: i32) -> f32 {
        value as f32 * self.unit
    }
}

const TURN: f32 = 1.0 / STEPS as f32;

/// Defines the registers and their list.
macro_rules! fields {
    ($($(#[$doc:meta])* $name:ident = $field:expr;)*) => {
        $($(#[$doc])* pub const $name: Field = $field;)*

        /// All registers, in the order of their addresses.
        pub const FIELDS: &[Field] = &[$($name),*];
    };
}

fields! {
    /// Major number of the firmware version.
    FIRMWARE_MAJOR = Field::read_only(0, 1, 3);
    /// Minor number of the firmware version.
    FIRMWARE_MINOR = Field::read_only(1, 1, 10);
    /// Order of bytes: 0 for little endian.
    BYTE_ORDER = Field::read_only(2, 1, 0);
    /// Number of the model: STS3215.
    MODEL = Field::read_only(3, 2, 777);
    /// Identifier on the bus.
    ID = Field::saved(5, 1, 1, 0, 253);
    /// Index of the bit rate.
    BAUD = Field::saved(6, 1, 0, 0, 7);
    /// Delay of an answer [s].
    RETURN_DELAY = Field::saved(7, 1, 0, 0, 254).unit(2e-6);
    /// Answers: 0 only to [`super::Instruction::Ping`] and to reads, 1 to every instruction.
    STATUS_LEVEL = Field::saved(8, 1, 1, 0, 1);
    /// Least goal position [turns]; any goal if this and [`MAX_POSITION`] are zero.
    MIN_POSITION = Field::saved(9, 2, 0, 0, 4095).unit(TURN);
    /// Largest goal position [turns].
    MAX_POSITION = Field::saved(11, 2, 4095, 0, 4095).unit(TURN);
    /// Temperature above which there is an error [deg C].
    MAX_TEMPERATURE = Field::saved(13, 1, 70, 0, 100);
    /// Voltage above which there is an error [V].
    MAX_VOLTAGE = Field::saved(14, 1, 140, 0, 254).unit(0.1);
    /// Voltage below which there is an error [V].
    MIN_VOLTAGE = Field::saved(15, 1, 40, 0, 254).unit(0.1);
    /// Value of [`TORQUE_LIMIT`] at power-up, as a part of the stall torque [-].
    MAX_TORQUE = Field::saved(16, 2, 1000, 0, 1000).unit(1e-3);
    /// Special functions, see [`super::phase`].
    PHASE = Field::saved(18, 1, 12, 0, 254);
    /// Error bits that take the torque off.
    UNLOADING = Field::saved(19, 1, 44, 0, 254);
    /// Error bits that let the light flash.
    LED_ALARM = Field::saved(20, 1, 47, 0, 254);
    /// Proportional gain of the position loop.
    POSITION_P = Field::saved(21, 1, 32, 0, 254);
    /// Differential gain of the position loop.
    POSITION_D = Field::saved(22, 1, 32, 0, 254);
    /// Integral gain of the position loop.
    POSITION_I = Field::saved(23, 1, 0, 0, 254);
    /// Least duty that moves the motor, as a part of the full duty [-].
    MIN_START = Field::saved(24, 1, 16, 0, 254).unit(1e-3);
    /// Largest integral of the position loop, as a part of the stall torque; 0 for no limit [-].
    INTEGRAL_LIMIT = Field::saved(25, 1, 0, 0, 254).unit(4e-3);
    /// Dead zone for a goal below the position [turns].
    DEAD_ZONE_CW = Field::saved(26, 1, 1, 0, 32).unit(TURN);
    /// Dead zone for a goal above the position [turns].
    DEAD_ZONE_CCW = Field::saved(27, 1, 1, 0, 32).unit(TURN);
    /// Current above which the time of [`OVERCURRENT_TIME`] runs [A].
    MAX_CURRENT = Field::saved(28, 2, 500, 0, 2047).unit(6.5e-3);
    /// Multiple of the smallest angle.
    RESOLUTION = Field::saved(30, 1, 1, 1, 128);
    /// Angle of the encoder at position zero [turns].
    OFFSET = Field::saved(31, 2, 0, -2047, 2047).signed(11).unit(TURN);
    /// Mode, see [`super::Mode`].
    MODE = Field::saved(33, 1, 0, 0, 3);
    /// Torque after an overload, as a part of the stall torque [-].
    PROTECTION_TORQUE = Field::saved(34, 1, 20, 0, 254).unit(0.01);
    /// Time of a load above [`OVERLOAD_TORQUE`] after which there is an error [s].
    OVERLOAD_TIME = Field::saved(35, 1, 200, 0, 254).unit(0.01);
    /// Load that is an overload, as a part of the stall torque [-].
    OVERLOAD_TORQUE = Field::saved(36, 1, 80, 0, 254).unit(0.01);
    /// Proportional gain of the speed loop.
    SPEED_P = Field::saved(37, 1, 10, 0, 254);
    /// Time of a current above [`MAX_CURRENT`] after which there is an error [s].
    OVERCURRENT_TIME = Field::saved(38, 1, 200, 0, 254).unit(0.01);
    /// Integral gain of the speed loop.
    SPEED_I = Field::saved(39, 1, 10, 0, 254);
    /// Torque: 0 off, 1 on, 2 shorted winding; 128 makes the present angle the middle.
    TORQUE_ENABLE = Field::volatile(40, 1, 0, 0, 128);
    /// Acceleration; 0 for the largest [turns/s^2].
    ACCELERATION = Field::volatile(41, 1, 0, 0, 254).unit(100.0 * TURN);
    /// Goal position [turns].
    GOAL_POSITION = Field::volatile(42, 2, 0, -32_767, 32_767).signed(15).unit(TURN);
    /// Goal of the duty in mode 2 [-].
    GOAL_DUTY = Field::volatile(44, 2, 0, -1000, 1000).signed(10).unit(1e-3);
    /// Goal speed [steps/s, or 50 steps/s: see [`super::phase::FINE_SPEED`]].
    GOAL_SPEED = Field::volatile(46, 2, 0, -32_767, 32_767).signed(15);
    /// Largest torque, as a part of the stall torque [-].
    TORQUE_LIMIT = Field::volatile(48, 2, 1000, 0, 1000).unit(1e-3);
    /// Lock: 0 if writes are kept over a power cycle.
    LOCK = Field::volatile(55, 1, 1, 0, 1);
    /// Position by the output encoder [turns].
    PRESENT_POSITION = Field::read_only(56, 2, 0).signed(15).unit(TURN);
    /// Speed by the output encoder, as [`GOAL_SPEED`].
    PRESENT_SPEED = Field::read_only(58, 2, 0).signed(15);
    /// Load, as a part of the stall torque [-].
    PRESENT_LOAD = Field::read_only(60, 2, 0).signed(10).unit(1e-3);
    /// Voltage [V].
    PRESENT_VOLTAGE = Field::read_only(62, 1, 0).unit(0.1);
    /// Temperature [deg C].
    PRESENT_TEMPERATURE = Field::read_only(63, 1, 0);
    /// One while a write waits for [`super::Instruction::Action`].
    REGISTERED = Field::read_only(64, 1, 0);
    /// Error bits, see [`super::error`].
    STATUS = Field::read_only(65, 1, 0);
    /// One while the output moves to its goal.
    MOVING = Field::read_only(66, 1, 0);
    /// Position that the loop follows [turns].
    TARGET_POSITION = Field::read_only(67, 2, 0).signed(15).unit(TURN);
    /// Current of the motor [A].
    PRESENT_CURRENT = Field::read_only(69, 2, 0).signed(15).unit(6.5e-3);
    /// Goal position of the last command [turns].
    LAST_GOAL = Field::read_only(71, 2, 0).signed(15).unit(TURN);
    /// Speed at which the output moves [50 steps/s].
    MOVING_SPEED = Field::saved(80, 1, 1, 0, 254).unit(50.0);
    /// Largest speed [steps/s].
    MAX_SPEED = Field::saved(84, 1, 68, 1, 254).unit(50.0);
    /// Largest acceleration [turns/s^2].
    MAX_ACCELERATION = Field::saved(85, 1, 254, 1, 254).unit(100.0 * TURN);
    /// Factor on [`MAX_ACCELERATION`] while [`ACCELERATION`] is 0 [-].
    ACCELERATION_FACTOR = Field::saved(86, 1, 1, 1, 254);
    /// Extension: angle of the rotor since power-up [counts of the motor encoder].
    MOTOR_POSITION = Field::read_only(96, 4, 0).complement();
    /// Extension: counts of the motor encoder in a turn of the rotor.
    MOTOR_COUNTS = Field::read_only(100, 4, 0).complement();
    /// Extension: speed of the rotor [counts/s].
    MOTOR_SPEED = Field::read_only(104, 4, 0).complement();
    /// Extension: numerator of the turns of the motor in a turn of the output.
    RATIO_NUMERATOR = Field::read_only(108, 2, 1);
    /// Extension: denominator of that ratio.
    RATIO_DENOMINATOR = Field::read_only(110, 2, 1);
}

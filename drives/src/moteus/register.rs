//! Registers: numbers, quantities and access. Server and client read this table.

use super::value::Scale;

macro_rules! registers {
    ($($name:ident = $number:literal, $scale:ident, $access:ident, $doc:literal;)*) => {
        $(#[doc = $doc] pub const $name: u32 = $number;)*

        /// Quantity and access of a register; `None` for a number without a register.
        pub fn describe(register: u32) -> Option<Field> {
            let (scale, access) = match register {
                $($name => (Scale::$scale, Access::$access),)*
                AUX1_ANALOG_1..=AUX1_ANALOG_5 | AUX2_ANALOG_1..=AUX2_ANALOG_5 => (Scale::Share, Access::Read),
                AUX1_PWM_1..=AUX2_PWM_5 => (Scale::Share, Access::Both),
                SERIAL_NUMBER_1..=SERIAL_NUMBER_3 | UUID_1..=UUID_4 => (Scale::Word, Access::Read),
                UUID_MASK_1..=UUID_MASK_4 => (Scale::Word, Access::Write),
                _ => return None,
            };
            Some(Field { scale, access })
        }
    };
}

/// Description of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Quantity.
    pub scale: Scale,
    /// Access.
    pub access: Access,
}

/// Access to a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Read only.
    Read,
    /// Write only.
    Write,
    /// Read and write.
    Both,
    /// Neither: a known number whose access is refused.
    Refused,
}

impl Access {
    /// True if the register can be read.
    pub fn is_readable(self) -> bool {
        matches!(self, Self::Read | Self::Both)
    }

    /// True if the register can be written.
    pub fn is_writable(self) -> bool {
        matches!(self, Self::Write | Self::Both)
    }
}

registers! {
    MODE = 0x000, Integer, Both, "Mode; to be written before the other registers of a frame.";
    POSITION = 0x001, Position, Read, "Position of the output.";
    VELOCITY = 0x002, Velocity, Read, "Speed of the output.";
    TORQUE = 0x003, Torque, Read, "Torque at the output.";
    Q_CURRENT = 0x004, Current, Read, "Torque-producing current.";
    D_CURRENT = 0x005, Current, Read, "Flux-producing current.";
    ABS_POSITION = 0x006, Position, Read, "Reading of encoder 1 within a turn.";
    POWER = 0x007, Power, Read, "Electrical power of the motor.";
    MOTOR_TEMPERATURE = 0x00a, Temperature, Read, "Temperature of the winding.";
    TRAJECTORY_COMPLETE = 0x00b, Integer, Read, "1 once the profile has come to its end.";
    HOME_STATE = 0x00c, Integer, Read, "Reference of the position: 0 none, 1 rotor, 2 output.";
    VOLTAGE = 0x00d, Voltage, Read, "Bus voltage.";
    TEMPERATURE = 0x00e, Temperature, Read, "Temperature of the power stage.";
    FAULT = 0x00f, Integer, Read, "Code of the fault, or of the limit that reduces the torque.";
    COMMAND_Q_CURRENT = 0x01c, Current, Both, "Torque-producing current of the current mode.";
    COMMAND_D_CURRENT = 0x01d, Current, Both, "Flux-producing current of the current mode.";
    COMMAND_POSITION = 0x020, Position, Both, "Position; NaN for the present one.";
    COMMAND_VELOCITY = 0x021, Velocity, Both, "Speed at which the position advances.";
    COMMAND_TORQUE = 0x022, Torque, Both, "Feed-forward torque.";
    COMMAND_KP_SCALE = 0x023, Share, Both, "Factor on the stiffness.";
    COMMAND_KD_SCALE = 0x024, Share, Both, "Factor on the damping.";
    COMMAND_MAX_TORQUE = 0x025, Torque, Both, "Largest torque; NaN for no limit.";
    COMMAND_STOP_POSITION = 0x026, Position, Both, "Position at which the motion stops; NaN for none.";
    COMMAND_TIMEOUT = 0x027, Time, Both, "Watchdog: 0 for the default, NaN for none.";
    COMMAND_VELOCITY_LIMIT = 0x028, Velocity, Both, "Largest speed: NaN for the default, negative for none.";
    COMMAND_ACCEL_LIMIT = 0x029, Acceleration, Both, "Largest acceleration: NaN for the default, negative for none.";
    COMMAND_FIXED_VOLTAGE = 0x02a, Voltage, Both, "Fixed voltage; ignored.";
    COMMAND_ILIMIT_SCALE = 0x02b, Share, Both, "Factor on the limit of the integral.";
    COMMAND_FIXED_CURRENT = 0x02c, Current, Both, "Fixed current; ignored.";
    COMMAND_IGNORE_BOUNDS = 0x02d, Integer, Both, "Not 0 to ignore the position bounds.";
    PROPORTIONAL_TORQUE = 0x030, Torque, Read, "Stiffness times position error, sensed minus control.";
    INTEGRAL_TORQUE = 0x031, Torque, Read, "Integral, with the sign of the position error.";
    DERIVATIVE_TORQUE = 0x032, Torque, Read, "Damping times speed error, sensed minus control.";
    FEEDFORWARD_TORQUE = 0x033, Torque, Read, "Feed-forward torque.";
    COMMAND_TORQUE_SUM = 0x034, Torque, Read, "Torque of the control, as register 0x03a.";
    CONTROL_POSITION = 0x038, Position, Read, "Position of the profile.";
    CONTROL_VELOCITY = 0x039, Velocity, Read, "Speed of the profile.";
    CONTROL_TORQUE = 0x03a, Torque, Read, "Torque of the control.";
    POSITION_ERROR = 0x03b, Position, Read, "Sensed position minus control position.";
    VELOCITY_ERROR = 0x03c, Velocity, Read, "Sensed speed minus control speed.";
    TORQUE_ERROR = 0x03d, Torque, Read, "Sensed torque minus control torque.";
    WITHIN_LOW = 0x040, Position, Both, "Lower bound; NaN for none.";
    WITHIN_HIGH = 0x041, Position, Both, "Upper bound; NaN for none.";
    WITHIN_TORQUE = 0x042, Torque, Both, "Shadow of 0x022.";
    WITHIN_KP_SCALE = 0x043, Share, Both, "Shadow of 0x023.";
    WITHIN_KD_SCALE = 0x044, Share, Both, "Shadow of 0x024.";
    WITHIN_MAX_TORQUE = 0x045, Torque, Both, "Shadow of 0x025.";
    WITHIN_TIMEOUT = 0x046, Time, Both, "Shadow of 0x027.";
    WITHIN_ILIMIT_SCALE = 0x047, Share, Both, "Shadow of 0x02b.";
    WITHIN_IGNORE_BOUNDS = 0x048, Integer, Both, "Shadow of 0x02d.";
    ENCODER_0_POSITION = 0x050, Position, Read, "Reading of encoder 0, at the motor, within a turn of the rotor.";
    ENCODER_0_VELOCITY = 0x051, Velocity, Read, "Speed of encoder 0, at the motor.";
    ENCODER_1_POSITION = 0x052, Position, Read, "Reading of encoder 1, at the output, within a turn.";
    ENCODER_1_VELOCITY = 0x053, Velocity, Read, "Speed of encoder 1, at the output.";
    ENCODER_2_POSITION = 0x054, Position, Read, "Reading of encoder 2, which is not configured.";
    ENCODER_2_VELOCITY = 0x055, Velocity, Read, "Speed of encoder 2, which is not configured.";
    ENCODER_VALIDITY = 0x058, Integer, Read, "Two bits for each encoder: angle valid, speed valid.";
    AUX1_GPIO_COMMAND = 0x05c, Integer, Both, "Outputs of port 1; ignored.";
    AUX2_GPIO_COMMAND = 0x05d, Integer, Both, "Outputs of port 2; ignored.";
    AUX1_GPIO_STATUS = 0x05e, Integer, Read, "Inputs of port 1; none.";
    AUX2_GPIO_STATUS = 0x05f, Integer, Read, "Inputs of port 2; none.";
    MILLISECOND_COUNTER = 0x070, Integer, Read, "Milliseconds since power-up.";
    CLOCK_TRIM = 0x071, Integer, Both, "Trim of the clock; kept, without effect.";
    AUX1_PWM_PERIOD = 0x072, Integer, Read, "Period of a PWM input; none.";
    AUX1_PWM_DUTY = 0x073, Share, Read, "Duty of a PWM input; NaN without a signal.";
    AUX2_PWM_PERIOD = 0x074, Integer, Read, "Period of a PWM input; none.";
    AUX2_PWM_DUTY = 0x075, Share, Read, "Duty of a PWM input; NaN without a signal.";
    MODEL_NUMBER = 0x100, Word, Read, "Model.";
    FIRMWARE_VERSION = 0x101, Word, Read, "Version of the firmware, a byte for each part.";
    REGISTER_MAP_VERSION = 0x102, Word, Read, "Version of the registers.";
    MULTIPLEX_ID = 0x110, Integer, Refused, "Identifier; documented as configurable, refused by the maker's firmware.";
    SET_OUTPUT_NEAREST = 0x130, Position, Write, "Sets the turn nearest to a position.";
    SET_OUTPUT_EXACT = 0x131, Position, Write, "Sets the position.";
    REQUIRE_REINDEX = 0x132, Integer, Write, "Sets the position as after power-up.";
    RECAPTURE = 0x133, Integer, Write, "Begins the control at the sensed position.";
    DRIVER_FAULT_1 = 0x140, Integer, Read, "Faults of the gate driver; none.";
    DRIVER_FAULT_2 = 0x141, Integer, Read, "Faults of the gate driver; none.";
    UUID_MASK_CAPABLE = 0x158, Integer, Read, "1 if the UUID masks are understood.";
}

/// First analog input of port 1.
pub const AUX1_ANALOG_1: u32 = 0x060;
/// Last analog input of port 1.
pub const AUX1_ANALOG_5: u32 = 0x064;
/// First analog input of port 2.
pub const AUX2_ANALOG_1: u32 = 0x068;
/// Last analog input of port 2.
pub const AUX2_ANALOG_5: u32 = 0x06c;
/// First PWM output of port 1; those of port 2 follow.
pub const AUX1_PWM_1: u32 = 0x076;
/// Last PWM output of port 2.
pub const AUX2_PWM_5: u32 = 0x07f;
/// Least significant word of the serial number.
pub const SERIAL_NUMBER_1: u32 = 0x120;
/// Most significant word of the serial number.
pub const SERIAL_NUMBER_3: u32 = 0x122;
/// First word of the UUID.
pub const UUID_1: u32 = 0x150;
/// Last word of the UUID.
pub const UUID_4: u32 = 0x153;
/// First word of the UUID mask: the rest of the frame is for the drive with this UUID.
pub const UUID_MASK_1: u32 = 0x154;
/// Last word of the UUID mask.
pub const UUID_MASK_4: u32 = 0x157;

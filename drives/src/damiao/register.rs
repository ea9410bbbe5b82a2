//! Registers of a drive: address, name, type and range.

use core::ops::Bound::{self, Excluded, Included};
use core::ops::RangeBounds;

pub use crate::value::Value;

/// Range of values: lower and upper bound.
type Range<T> = (Bound<T>, Bound<T>);

/// Finite numbers above zero.
const POSITIVE: Range<f32> = (Excluded(0.0), Included(f32::MAX));
/// Finite numbers below zero.
const NEGATIVE: Range<f32> = (Included(f32::MIN), Excluded(0.0));
/// Zero and finite numbers above.
const NOT_NEGATIVE: Range<f32> = (Included(0.0), Included(f32::MAX));
/// Identifiers of 11 bits.
const IDENTIFIER: Range<u32> = (Included(0), Included(0x7FF));

/// Type of a register, with the range of values that it accepts; `None` for one that can only be read.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    /// f32.
    Float(Option<Range<f32>>),
    /// u32.
    Whole(Option<Range<u32>>),
}

macro_rules! registers {
    ($($(#[$doc:meta])* $register:ident = $address:literal, $name:literal, $form:expr;)*) => {
        /// Register.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Register {
            $($(#[$doc])* $register,)*
        }

        impl Register {
            /// All registers.
            pub const ALL: &[Self] = &[$(Self::$register),*];

            /// Register of an address; `None` without one.
            pub fn from_address(address: u8) -> Option<Self> {
                match address {
                    $($address => Some(Self::$register),)*
                    _ => None,
                }
            }

            /// Address.
            pub fn address(self) -> u8 {
                match self {
                    $(Self::$register => $address,)*
                }
            }

            /// Name in the maker's documents.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$register => $name,)*
                }
            }

            /// Type and range.
            pub fn form(self) -> Form {
                match self {
                    $(Self::$register => $form,)*
                }
            }
        }
    };
}

registers! {
    /// Bus voltage below which the drive has a fault [V].
    UnderVoltage = 0, "UV_Value", Float(Some((Excluded(10.0), Included(f32::MAX))));
    /// Torque coefficient by the user [N m/A]; 0 for the one that was identified.
    TorqueCoefficient = 1, "KT_Value", Float(Some(NOT_NEGATIVE));
    /// Temperature of the winding that is a fault [deg C].
    OverTemperature = 2, "OT_Value", Float(Some((Included(80.0), Excluded(200.0))));
    /// Current that is a fault, as a share of the largest [-].
    OverCurrent = 3, "OC_Value", Float(Some((Excluded(0.0), Excluded(1.0))));
    /// Acceleration of profiles [rad/s^2].
    Acceleration = 4, "ACC", Float(Some(POSITIVE));
    /// Deceleration of profiles, negative [rad/s^2].
    Deceleration = 5, "DEC", Float(Some(NEGATIVE));
    /// Largest speed [rad/s].
    MaxSpeed = 6, "MAX_SPD", Float(Some(POSITIVE));
    /// Identifier of feedback frames.
    FeedbackId = 7, "MST_ID", Whole(Some(IDENTIFIER));
    /// Identifier of the drive.
    Id = 8, "ESC_ID", Whole(Some(IDENTIFIER));
    /// Time without a command after which the drive has a fault [50 us]; 0 for none.
    Timeout = 9, "TIMEOUT", Whole(Some((Included(0), Included(u32::MAX))));
    /// Code of the control mode.
    ControlMode = 10, "CTRL_MODE", Whole(Some((Included(1), Included(4))));
    /// Viscous damping of the motor.
    Damping = 11, "Damp", Float(None);
    /// Inertia of the motor [kg m^2].
    Inertia = 12, "Inertia", Float(None);
    /// Reserved: version of the hardware.
    HardwareVersion = 13, "hw_ver", Whole(None);
    /// Version of the software.
    SoftwareVersion = 14, "sw_ver", Whole(None);
    /// Reserved: serial number.
    SerialNumber = 15, "SN", Whole(None);
    /// Pole pairs.
    PolePairs = 16, "NPP", Whole(None);
    /// Resistance of the winding [ohm].
    Resistance = 17, "Rs", Float(None);
    /// Inductance of the winding [H].
    Inductance = 18, "Ls", Float(None);
    /// Flux linkage [Wb].
    Flux = 19, "Flux", Float(None);
    /// Ratio of the gear [-].
    GearRatio = 20, "Gr", Float(None);
    /// Range of positions [rad].
    PositionRange = 21, "PMAX", Float(Some(POSITIVE));
    /// Range of velocities [rad/s].
    VelocityRange = 22, "VMAX", Float(Some(POSITIVE));
    /// Range of torques [N m].
    TorqueRange = 23, "TMAX", Float(Some(POSITIVE));
    /// Bandwidth of the current loop.
    CurrentBandwidth = 24, "I_BW", Float(Some((Included(100.0), Included(10_000.0))));
    /// Gain of the speed loop.
    VelocityGain = 25, "KP_ASR", Float(Some(NOT_NEGATIVE));
    /// Integral gain of the speed loop.
    VelocityIntegral = 26, "KI_ASR", Float(Some(NOT_NEGATIVE));
    /// Gain of the position loop [1/s].
    PositionGain = 27, "KP_APR", Float(Some(NOT_NEGATIVE));
    /// Integral gain of the position loop.
    PositionIntegral = 28, "KI_APR", Float(Some(NOT_NEGATIVE));
    /// Bus voltage above which the drive has a fault [V].
    OverVoltage = 29, "OV_Value", Float(Some(POSITIVE));
    /// Efficiency of the gear [-].
    GearEfficiency = 30, "GREF", Float(Some((Excluded(0.0), Included(1.0))));
    /// Damping factor from which the speed loop is tuned [-].
    DampingFactor = 31, "Deta", Float(Some((Included(1.0), Included(30.0))));
    /// Bandwidth of the speed filter.
    FilterBandwidth = 32, "V_BW", Float(Some((Excluded(0.0), Excluded(500.0))));
    /// Enhancement of the current loop.
    CurrentEnhancement = 33, "IQ_c1", Float(Some((Included(100.0), Included(10_000.0))));
    /// Enhancement of the speed loop.
    VelocityEnhancement = 34, "VL_c1", Float(Some((Excluded(0.0), Included(10_000.0))));
    /// Code of the bit rate.
    BitRate = 35, "can_br", Whole(Some((Included(0), Included(4))));
    /// Second part of the software's version.
    SubVersion = 36, "sub_ver", Whole(None);
    /// Offset of the current in phase u.
    OffsetU = 50, "u_off", Float(None);
    /// Offset of the current in phase v.
    OffsetV = 51, "v_off", Float(None);
    /// First factor of the encoder's correction.
    CorrectionOne = 52, "k1", Float(None);
    /// Second factor of the encoder's correction.
    CorrectionTwo = 53, "k2", Float(None);
    /// Offset of the angle.
    AngleOffset = 54, "m_off", Float(None);
    /// Direction of the motor: 1 or -1.
    Direction = 55, "dir", Float(None);
    /// Offset of the motor encoder. Not in the manual, but in the client, like 59 to 65.
    MotorOffset = 56, "m_off", Float(None);
    /// Largest current [A].
    MaxCurrent = 59, "Imax", Float(None);
    /// Bus voltage [V].
    BusVoltage = 60, "VBus", Float(None);
    /// Temperature of the power stage [deg C].
    BoardTemperature = 61, "Tpcb", Float(None);
    /// Temperature of the winding [deg C].
    MotorTemperature = 62, "Tmtr", Float(None);
    /// Offset of the current sensor in phase u.
    SensorOffsetU = 63, "Iu_off", Float(None);
    /// Offset of the current sensor in phase v.
    SensorOffsetV = 64, "Iv_off", Float(None);
    /// Offset of the current sensor in phase w.
    SensorOffsetW = 65, "Iw_off", Float(None);
    /// Position of the output by the motor encoder and the ratio [rad].
    MotorPosition = 80, "p_m", Float(None);
    /// Position of the output by its own encoder [rad].
    OutputPosition = 81, "xout", Float(None);
}

use Form::{Float, Whole};

impl Register {
    /// Value of four bytes.
    pub fn value(self, bytes: [u8; 4]) -> Value {
        match self.form() {
            Float(_) => Value::F32(f32::from_le_bytes(bytes)),
            Whole(_) => Value::U32(u32::from_le_bytes(bytes)),
        }
    }

    /// True if the register can be written and the value is in its range.
    pub fn accepts(self, value: Value) -> bool {
        match (self.form(), value) {
            (Float(Some(range)), Value::F32(value)) => range.contains(&value),
            (Whole(Some(range)), Value::U32(value)) => range.contains(&value),
            _ => false,
        }
    }

    /// True if the register can be written.
    pub fn is_writable(self) -> bool {
        matches!(self.form(), Float(Some(_)) | Whole(Some(_)))
    }
}

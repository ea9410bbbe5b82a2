//! Parameters: index, kind and access of each, shared by drive and client.

use super::model::{Model, Sheet};
pub use crate::value::{Kind, Value};

/// Parameter by its name in the makers' tables. All quantities are those of the output but for counts, `ModPos`,
/// `Rotation`, `MechOffset` and currents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Run mode; writable.
    RunMode,
    /// Current reference [A]; writable.
    IqRef,
    /// Speed reference [rad/s]; writable.
    SpdRef,
    /// Torque limit [N m]; writable.
    LimitTorque,
    /// Gain of the current loop; writable, stored only.
    CurKp,
    /// Integral gain of the current loop; writable, stored only.
    CurKi,
    /// Filter of the current; writable, stored only.
    CurFiltGain,
    /// Angle reference [rad]; writable.
    LocRef,
    /// Speed limit of the cyclic position mode [rad/s]; writable.
    LimitSpd,
    /// Current limit of position and speed mode [A]; writable.
    LimitCur,
    /// Angle by the rotor's encoder with all turns [rad].
    MechPos,
    /// Filtered current [A].
    Iqf,
    /// Speed [rad/s].
    MechVel,
    /// Bus voltage [V].
    Vbus,
    /// Whole turns of the rotor.
    Rotation,
    /// Gain of the angle loop [1/s]; writable.
    LocKp,
    /// Gain of the speed loop [A s/rad]; writable.
    SpdKp,
    /// Integral gain of the speed loop [A/rad in 50 us]; writable.
    SpdKi,
    /// Filter of the speed; writable, stored only.
    SpdFiltGain,
    /// Acceleration of the speed mode [rad/s^2]; writable.
    AccRad,
    /// Speed of the profile [rad/s]; writable.
    VelMax,
    /// Acceleration of the profile [rad/s^2]; writable.
    AccSet,
    /// Interval of reports: 1 for 10 ms, 5 ms for each further 1; writable.
    EpscanTime,
    /// Time without a frame until the drive resets [50 us], 0 for none; writable.
    CanTimeout,
    /// Range of the angle at power-up; writable, stored only.
    ZeroSta,
    /// Damping switch; writable, stored only.
    Damper,
    /// Offset of the zero [rad]; writable, stored only.
    AddOffset,
    /// Address of the drive; set by the frame for it only.
    CanId,
    /// Address of the host; writable.
    CanMaster,
    /// Temperature that is a fault [0.1 deg C]; writable.
    MotorOverTemp,
    /// Ratio of the gear.
    GearRatio,
    /// Angle of the rotor at the zero of the output [rad].
    MechOffset,
    /// Counts of the rotor's encoder, 14 bits.
    EncoderRaw,
    /// Temperature of the controller [0.1 deg C].
    McuTemp,
    /// Temperature of the winding [0.1 deg C].
    MotorTemp,
    /// Bus voltage [mV].
    VbusMillivolts,
    /// Counts of the second encoder, 14 bits.
    Encoder2Raw,
    /// Current command [A].
    CmdIq,
    /// Angle command of the position loop [rad].
    CmdLocRef,
    /// Speed command of the speed loop [rad/s].
    CmdSpdRef,
    /// Torque command [N m].
    CmdTorque,
    /// Angle within the rotor's turn [rad].
    ModPos,
    /// Temperature of the power stage [0.1 deg C].
    BoardTemp,
    /// Current [A].
    Iq,
    /// Faults as in the fault frame.
    FaultSta,
    /// Warnings as in the fault frame.
    WarnSta,
    /// Torque by the current [N m].
    TorqueFdb,
    /// Angle by the second encoder with all turns [rad].
    ChasuAngleOut,
}

use Parameter as P;

/// Parameters of both makers.
const COMMON: [(u16, Parameter); 17] = [
    (0x7005, P::RunMode),
    (0x7006, P::IqRef),
    (0x700A, P::SpdRef),
    (0x700B, P::LimitTorque),
    (0x7010, P::CurKp),
    (0x7011, P::CurKi),
    (0x7014, P::CurFiltGain),
    (0x7016, P::LocRef),
    (0x7017, P::LimitSpd),
    (0x7018, P::LimitCur),
    (0x7019, P::MechPos),
    (0x701A, P::Iqf),
    (0x701B, P::MechVel),
    (0x701C, P::Vbus),
    (0x701E, P::LocKp),
    (0x701F, P::SpdKp),
    (0x7020, P::SpdKi),
];

/// Parameters and configuration of CyberGear alone.
const CYBERGEAR: [(u16, Parameter); 4] =
    [(0x701D, P::Rotation), (0x2007, P::LimitTorque), (0x200D, P::MotorOverTemp), (0x200F, P::GearRatio)];

/// Parameters of RobStride alone.
const ROBSTRIDE: [(u16, Parameter); 9] = [
    (0x7021, P::SpdFiltGain),
    (0x7022, P::AccRad),
    (0x7024, P::VelMax),
    (0x7025, P::AccSet),
    (0x7026, P::EpscanTime),
    (0x7028, P::CanTimeout),
    (0x7029, P::ZeroSta),
    (0x702A, P::Damper),
    (0x702B, P::AddOffset),
];

/// Configuration of both makers.
const CONFIGURATION: [(u16, Parameter); 10] = [
    (0x2005, P::MechOffset),
    (0x2011, P::CurFiltGain),
    (0x2012, P::CurKp),
    (0x2013, P::CurKi),
    (0x2014, P::SpdKp),
    (0x2015, P::SpdKi),
    (0x2016, P::LocKp),
    (0x2017, P::SpdFiltGain),
    (0x2018, P::LimitSpd),
    (0x2019, P::LimitCur),
];

/// Observations of both makers, as CyberGear numbers them.
const OBSERVATIONS: [(u16, Parameter); 18] = [
    (0x3004, P::EncoderRaw),
    (0x3005, P::McuTemp),
    (0x3006, P::MotorTemp),
    (0x300C, P::Vbus),
    (0x300E, P::CmdIq),
    (0x300F, P::CmdLocRef),
    (0x3010, P::CmdSpdRef),
    (0x3011, P::CmdTorque),
    (0x3014, P::Rotation),
    (0x3015, P::ModPos),
    (0x3016, P::MechPos),
    (0x3017, P::MechVel),
    (0x301E, P::Iqf),
    (0x301F, P::BoardTemp),
    (0x3020, P::Iq),
    (0x3022, P::FaultSta),
    (0x3023, P::WarnSta),
    (0x3007, P::VbusMillivolts),
];

impl Model {
    /// Indices and parameters of the model; the preferred index of a parameter comes first.
    fn places(self) -> impl Iterator<Item = (u16, Parameter)> {
        let sheet = self.sheet();
        let own: &[(u16, Parameter)] = if self.is_robstride() { &ROBSTRIDE } else { &CYBERGEAR };
        let addresses =
            [(0, P::CanId), (1, P::CanMaster), (2, P::CanTimeout)].map(|(place, name)| (sheet.can_index + place, name));
        let second = [
            sheet.second_counts_index.map(|index| (index, P::Encoder2Raw)),
            sheet.second_angle_index.map(|index| (index, P::ChasuAngleOut)),
            Some((sheet.torque_index, P::TorqueFdb)),
        ];
        // A second encoder's counts take the place of the voltage.
        let observations = OBSERVATIONS.into_iter().filter(move |(index, _)| Some(*index) != sheet.second_counts_index);
        let is_moved = move |index: u16| sheet.is_shifted && index > 0x3010;
        let observations = observations.map(move |(index, name)| (index + u16::from(is_moved(index)), name));
        let written = COMMON.into_iter().chain(own.iter().copied()).chain(CONFIGURATION).chain(addresses);
        written.chain(second.into_iter().flatten()).chain(observations)
    }

    /// Parameter at an index.
    pub fn parameter(self, index: u16) -> Option<Parameter> {
        self.places().find_map(|(place, parameter)| (place == index).then_some(parameter))
    }

    /// Index of a parameter; `None` if the model does not have it.
    pub fn index(self, parameter: Parameter) -> Option<u16> {
        self.places().find_map(|(place, own)| (own == parameter).then_some(place))
    }
}

impl Parameter {
    /// Kind of the value.
    pub fn kind(self) -> Kind {
        match self {
            P::RunMode | P::ZeroSta | P::Damper | P::CanId | P::CanMaster => Kind::U8,
            P::Rotation | P::MotorOverTemp | P::McuTemp | P::MotorTemp | P::BoardTemp => Kind::I16,
            P::EpscanTime | P::EncoderRaw | P::Encoder2Raw | P::VbusMillivolts => Kind::U16,
            P::CanTimeout | P::FaultSta | P::WarnSta => Kind::U32,
            _ => Kind::F32,
        }
    }

    /// Least and largest value that a drive accepts for a number with a fraction.
    pub(super) fn range(self, sheet: &Sheet) -> (f32, f32) {
        match self {
            P::IqRef => (-sheet.current, sheet.current),
            P::LimitCur => (0.0, sheet.current),
            P::SpdRef => (sheet.speed.low, sheet.speed.high),
            P::LimitSpd | P::VelMax => (0.0, sheet.speed.high),
            P::LimitTorque => (0.0, sheet.torque.high),
            P::CurFiltGain | P::SpdFiltGain => (0.0, 1.0),
            P::CurKp | P::CurKi | P::LocKp | P::SpdKp | P::SpdKi => (0.0, 200.0),
            P::AccRad | P::AccSet => (0.0, 1000.0),
            P::AddOffset => (-7.0, 7.0),
            _ => (f32::MIN, f32::MAX),
        }
    }
}

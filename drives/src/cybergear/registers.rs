//! Parameters of a drive: references, limits and settings behind their indices.

use core::f32::consts::TAU;

use super::faults::{fault_word, warning_word};
use super::model::Model;
use super::parameter::{Parameter as P, Value};
use crate::drive::{Drive, ProfileLimits, SetPoint, Settings, State, Target};
use crate::scale::round;
use crate::turns::Turns;

/// Ticks of timeout and speed integral in a second.
const TICKS: f32 = 20_000.0;
/// Counts of both encoders in a turn, as the makers' encoders have them.
const COUNTS: u32 = 1 << 14;

/// Run mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunMode {
    /// Stiffness and damping by the operation frame.
    Operation,
    /// Position; with a profile on RobStride.
    Position,
    /// Speed.
    Speed,
    /// Current.
    Current,
    /// Cyclic position of RobStride.
    CyclicPosition,
}

impl RunMode {
    /// Number of the mode.
    pub fn number(self) -> u8 {
        match self {
            Self::Operation => 0,
            Self::Position => 1,
            Self::Speed => 2,
            Self::Current => 3,
            Self::CyclicPosition => 5,
        }
    }

    /// Mode of a number on a model.
    pub fn new(model: Model, number: u8) -> Option<Self> {
        match number {
            0 => Some(Self::Operation),
            1 => Some(Self::Position),
            2 => Some(Self::Speed),
            3 => Some(Self::Current),
            5 if model.is_robstride() => Some(Self::CyclicPosition),
            _ => None,
        }
    }
}

/// Parameters that are no [`Settings`].
#[derive(Debug, Clone)]
pub(super) struct Registers {
    pub model: Model,
    pub mode: RunMode,
    /// Address of the host.
    pub host: u8,
    /// Address of the drive.
    pub drive: u8,
    iq_ref: f32,
    spd_ref: f32,
    /// Angle reference; `None` until it is written.
    pub loc_ref: Option<Turns>,
    limit_spd: f32,
    limit_cur: f32,
    acc_rad: f32,
    vel_max: f32,
    acc_set: f32,
    epscan_time: u16,
    cur_kp: f32,
    cur_ki: f32,
    cur_filt_gain: f32,
    spd_filt_gain: f32,
    zero_sta: u8,
    damper: u8,
    add_offset: f32,
}

impl Registers {
    /// Parameters as ex works: CyberGear manual 3.3.3 and 4.1.12, RobStride manuals 4.1.13.
    pub fn new(drive: u8, model: Model) -> Self {
        let is_robstride = model.is_robstride();
        Self {
            model,
            mode: RunMode::Operation,
            host: if is_robstride { 0xFD } else { 0 },
            drive,
            iq_ref: 0.0,
            spd_ref: 0.0,
            loc_ref: None,
            limit_spd: 2.0,
            limit_cur: model.sheet().current,
            acc_rad: if model == Model::RobStride04 { 15.0 } else { 20.0 },
            vel_max: 10.0,
            acc_set: 10.0,
            epscan_time: 1,
            cur_kp: if is_robstride { 0.17 } else { 0.125 },
            cur_ki: if is_robstride { 0.012 } else { 0.0158 },
            cur_filt_gain: 0.1,
            spd_filt_gain: 0.1,
            zero_sta: 0,
            damper: 0,
            add_offset: 0.0,
        }
    }

    /// Forgets all references.
    pub fn release(&mut self) {
        (self.iq_ref, self.spd_ref, self.loc_ref) = (0.0, 0.0, None);
    }

    /// Time between two reports [s].
    pub fn report_interval(&self) -> f32 {
        0.01 + 0.005 * f32::from(self.epscan_time.saturating_sub(1))
    }

    /// Set-point of the run mode; `None` in the operation mode.
    pub fn set_point(&self, drive: &Drive) -> Option<SetPoint> {
        let torque_per_ampere = torque_per_ampere(drive.settings());
        let max_torque = self.limit_cur * torque_per_ampere;
        let angle = self.loc_ref.unwrap_or(drive.feedback().position);
        let hold = Target { max_torque, ..Target::hold(angle) };
        match self.mode {
            RunMode::Operation => None,
            RunMode::Position if self.model.is_robstride() => {
                let limits = ProfileLimits { velocity: self.vel_max, acceleration: self.acc_set };
                Some(SetPoint::Position(Target { limits, ..hold }))
            }
            RunMode::Position | RunMode::CyclicPosition => Some(SetPoint::Position(hold)),
            RunMode::Speed => {
                let max_acceleration = if self.model.is_robstride() { self.acc_rad } else { f32::INFINITY };
                Some(SetPoint::Velocity { velocity: self.spd_ref, torque: 0.0, max_acceleration, max_torque })
            }
            RunMode::Current => {
                Some(SetPoint::Torque { torque: self.iq_ref * torque_per_ampere, max_velocity: f32::INFINITY })
            }
        }
    }

    /// Largest commanded speed in the run mode [rad/s].
    pub fn max_velocity(&self) -> f32 {
        match self.mode {
            RunMode::CyclicPosition => self.limit_spd,
            RunMode::Position if !self.model.is_robstride() => self.limit_spd,
            _ => self.model.sheet().speed.high,
        }
    }

    /// Value of a parameter; `None` for the second encoder of a drive without one.
    pub fn read(&self, parameter: P, drive: &Drive) -> Option<Value> {
        let (settings, now) = (drive.settings(), drive.feedback());
        let (ratio, torque_per_ampere) = (settings.ratio.to_f32(), torque_per_ampere(settings));
        let tenths = |temperature: f32| Value::I16(round(10.0 * temperature) as i16);
        let counts = |angle: Turns| Value::U16((angle.to_counts(COUNTS) & i64::from(COUNTS - 1)) as u16);
        let number = match parameter {
            P::RunMode => return Some(Value::U8(self.mode.number())),
            P::ZeroSta => return Some(Value::U8(self.zero_sta)),
            P::Damper => return Some(Value::U8(self.damper)),
            P::CanId => return Some(Value::U8(self.drive)),
            P::CanMaster => return Some(Value::U8(self.host)),
            P::Rotation => return Some(Value::I16(whole_turns(now.motor_position))),
            P::MotorOverTemp => return Some(tenths(settings.max_temperature)),
            P::McuTemp | P::BoardTemp => return Some(tenths(now.sensors.board_temperature)),
            P::MotorTemp => return Some(tenths(now.sensors.motor_temperature)),
            P::EpscanTime => return Some(Value::U16(self.epscan_time)),
            P::EncoderRaw => return Some(counts(now.motor_position)),
            P::Encoder2Raw => return now.output_position.map(counts),
            P::VbusMillivolts => return Some(Value::U16(round(1000.0 * now.sensors.bus_voltage) as u16)),
            P::CanTimeout => return Some(Value::U32(round(TICKS * settings.watchdog.unwrap_or_default()) as u32)),
            P::FaultSta => return Some(Value::U32(fault_word(drive))),
            P::WarnSta => return Some(Value::U32(warning_word(self.model, drive))),
            P::ChasuAngleOut => now.output_position?.to_rad(),
            P::IqRef => self.iq_ref,
            P::SpdRef => self.spd_ref,
            P::LimitTorque => settings.torque_limit * ratio,
            P::CurKp => self.cur_kp,
            P::CurKi => self.cur_ki,
            P::CurFiltGain => self.cur_filt_gain,
            P::LocRef => self.loc_ref.unwrap_or(now.position).to_rad(),
            P::LimitSpd => self.limit_spd,
            P::LimitCur => self.limit_cur,
            P::MechPos => now.position.to_rad(),
            P::Iqf | P::Iq => now.current,
            P::MechVel => now.velocity,
            P::Vbus => now.sensors.bus_voltage,
            P::LocKp => settings.gains.position,
            P::SpdKp => settings.gains.velocity / torque_per_ampere,
            P::SpdKi => settings.gains.velocity_integral / torque_per_ampere / TICKS,
            P::SpdFiltGain => self.spd_filt_gain,
            P::AccRad => self.acc_rad,
            P::VelMax => self.vel_max,
            P::AccSet => self.acc_set,
            P::AddOffset => self.add_offset,
            P::GearRatio => ratio,
            P::MechOffset => now.motor_position.minus(now.position.times(settings.ratio)).to_rad(),
            P::CmdIq => now.demand / torque_per_ampere,
            P::CmdLocRef => now.target.to_rad(),
            P::CmdSpdRef => now.target_velocity,
            P::CmdTorque => now.demand,
            P::ModPos => TAU * (now.motor_position.to_bits() as u32 as f32 / (1_u64 << 32) as f32),
            P::TorqueFdb => now.torque,
        };
        Some(Value::F32(number))
    }

    /// Writes a parameter; a value that the drive cannot take and a read-only parameter change nothing.
    pub fn write(&mut self, parameter: P, value: Value, drive: &mut Drive) {
        match value {
            Value::F32(value) if value.is_nan() => {}
            Value::F32(value) => {
                let (low, high) = parameter.range(&self.model.sheet());
                self.write_number(parameter, value.max(low).min(high), drive);
            }
            Value::U8(value) => self.write_byte(parameter, value, drive),
            Value::I16(value) if parameter == P::MotorOverTemp && (0..=1500).contains(&value) => {
                let temperature = f32::from(value) / 10.0;
                let settings = drive.settings_mut();
                (settings.max_temperature, settings.derating_temperature) = (temperature, temperature);
            }
            Value::U16(value) if parameter == P::EpscanTime => self.epscan_time = value.max(1),
            Value::U32(ticks) if parameter == P::CanTimeout => {
                drive.set_watchdog((ticks > 0).then_some(ticks as f32 / TICKS));
            }
            _ => {}
        }
    }

    fn write_byte(&mut self, parameter: P, value: u8, drive: &Drive) {
        match parameter {
            P::RunMode if drive.state() == State::Disabled => {
                self.mode = RunMode::new(self.model, value).unwrap_or(self.mode);
            }
            P::CanMaster => self.host = value,
            P::ZeroSta => self.zero_sta = value,
            P::Damper => self.damper = value,
            _ => {}
        }
    }

    fn write_number(&mut self, parameter: P, value: f32, drive: &mut Drive) {
        let settings = drive.settings_mut();
        let (ratio, torque_per_ampere) = (settings.ratio.to_f32(), torque_per_ampere(settings));
        match parameter {
            P::IqRef => self.iq_ref = value,
            P::SpdRef => self.spd_ref = value,
            P::LimitTorque => settings.torque_limit = value / ratio,
            P::CurKp => self.cur_kp = value,
            P::CurKi => self.cur_ki = value,
            P::CurFiltGain => self.cur_filt_gain = value,
            P::LocRef => self.loc_ref = Some(Turns::from_rad(value)),
            P::LimitSpd => self.limit_spd = value,
            P::LimitCur => self.limit_cur = value,
            P::LocKp => settings.gains.position = value,
            P::SpdKp => settings.gains.velocity = value * torque_per_ampere,
            P::SpdKi => settings.gains.velocity_integral = value * TICKS * torque_per_ampere,
            P::SpdFiltGain => self.spd_filt_gain = value,
            P::AccRad => self.acc_rad = value,
            P::VelMax => self.vel_max = value,
            P::AccSet => self.acc_set = value,
            P::AddOffset => self.add_offset = value,
            _ => {}
        }
    }
}

/// Torque at the output for a current of the winding [N m/A].
fn torque_per_ampere(settings: &Settings) -> f32 {
    (settings.torque_constant * settings.ratio.to_f32()).max(f32::MIN_POSITIVE)
}

/// Whole turns below an angle.
fn whole_turns(angle: Turns) -> i16 {
    (angle.to_bits() >> 32).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}

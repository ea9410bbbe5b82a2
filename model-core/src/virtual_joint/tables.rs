//! Tables of a virtual joint's surroundings, made by `virtual_joint::design`: current loop, frictions, weight, encoders. SI; angles that wrap are whole numbers of 2^-32 turns.

use crate::numbers::Real;
use crate::observer::tables::MOST_DELAY;

/// Places for delayed commands to the motor.
pub const COMMANDS_IN_FLIGHT: usize = MOST_DELAY + 1;

/// Surroundings of one joint at one tick rate; a tick is a control period.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct SurroundingsTable<T: Real> {
    /// Control period [s].
    pub period: T,
    /// Ticks of the samples' clock in a control period.
    pub clock_ticks: u32,
    /// A whole turn [rad].
    pub turn: T,
    /// Motor turns over link turns as a fraction of whole numbers.
    pub ratio: [u32; 2],
    /// The same as a number.
    pub gear: T,
    /// 2^-32 turns in a radian.
    pub units_per_radian: T,
    /// Motor speed beyond the rigid body's, for each unit of rate of: any planet, gap, wind-up [rad/s].
    pub motor_rate: [T; 3],
    /// Link speed likewise [rad/s].
    pub link_rate: [T; 3],
    /// From command to air gap.
    pub current: CurrentLoopTable<T>,
    /// Cogging: amplitude [N m].
    pub cogging_torque: T,
    /// Its periods in a turn of the motor.
    pub cogging_periods: u32,
    /// At the motor.
    pub motor_friction: FrictionTable<T>,
    /// At the link.
    pub load_friction: FrictionTable<T>,
    /// Dry friction in proportion to the torque that the sun transmits, while the motor drives and while it is driven.
    pub losses: [T; 2],
    /// Half-backlash of the sun's meshes, one for each planet [m].
    pub half_backlash: [T; 5],
    /// Torque of a sun's mesh at the sun for each metre beyond its flank [N m/m].
    pub sun_torque: T,
    /// Torque of the gears on the link, for each unit of: sun's torque, wind-up, rate of wind-up [N m].
    pub to_link: [T; 3],
    /// Weight [N m].
    pub weight: T,
    /// Motor's and link's.
    pub encoders: [EncoderErrorTable<T>; 2],
}

/// From commanded torque to torque in the air gap.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CurrentLoopTable<T: Real> {
    /// Whole periods of delay, less than [`COMMANDS_IN_FLIGHT`].
    pub delay: u32,
    /// Share of the missing torque that is made up in a period.
    pub rise: T,
    /// Share of the missing torque that is missing on average over a period.
    pub lacking: T,
    /// True over nominal torque constant.
    pub gain: T,
    /// Largest torque [N m].
    pub limit: T,
}

/// Friction of one shaft.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct FrictionTable<T: Real> {
    /// Dry friction at speed [N m].
    pub coulomb: T,
    /// Viscous friction [N m s/rad].
    pub viscous: T,
    /// Rise of dry friction at rest, as a torque [N m].
    pub rise: T,
    /// Inverse of the speed at which half of that rise is left [s/rad].
    pub per_speed: T,
    /// Torque that stops the shaft from a unit of speed within a period [N m s/rad].
    pub stop: T,
}

/// Errors of an encoder.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct EncoderErrorTable<T: Real> {
    /// 32 less its bits.
    pub shift: u32,
    /// Amplitudes of the errors that come once and twice a turn [2^-32 turns].
    pub errors: [T; 2],
    /// How far a reading lags behind at a unit of speed [2^-32 turns s/rad].
    pub lag: T,
}

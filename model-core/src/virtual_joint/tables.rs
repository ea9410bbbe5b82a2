//! Tables of a virtual joint's surroundings, made by `virtual_joint::design`: current loop, frictions, weight,
//! encoders. SI units; angles that wrap are integers in 2^-32 turns.

use crate::gears::Tables;
use crate::numbers::Real;
use crate::observer::tables::MOST_DELAY;

/// Capacity for delayed motor commands.
pub const COMMAND_QUEUE_LENGTH: usize = MOST_DELAY + 1;

/// Tables of a virtual joint with `N` planets.
#[cfg_attr(feature = "design", doc = "[`VirtualJointDesign::new`] designs them.")]
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualJointDesign<const N: usize, T: Real = f32> {
    /// Table of the gears.
    pub gears: Tables<T, N>,
    /// Table of the surroundings.
    pub surroundings: SurroundingsTable<T>,
}

/// Surroundings of one joint at one tick rate; a tick is a control period.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct SurroundingsTable<T: Real> {
    /// Control period [s].
    pub period: T,
    /// Ticks of the samples' clock per control period.
    pub clock_ticks: u32,
    /// A whole turn [rad].
    pub turn: T,
    /// Motor turns over link turns as a fraction of integers.
    pub ratio: [u32; 2],
    /// Motor turns over link turns [-].
    pub gear: T,
    /// Units of 2^-32 turns per radian.
    pub units_per_radian: T,
    /// Motor speed relative to the rigid body, per unit of the rate of: any planet, gap, wind-up [rad/s].
    pub motor_rate: [T; 3],
    /// Link speed relative to the rigid body, per unit of the rate of: any planet, gap, wind-up [rad/s].
    pub link_rate: [T; 3],
    /// Current loop: from command to air gap.
    pub current: CurrentLoopTable<T>,
    /// Cogging amplitude [N m].
    pub cogging_torque: T,
    /// Cogging periods per motor turn.
    pub cogging_periods: u32,
    /// Friction of the motor.
    pub motor_friction: FrictionTable<T>,
    /// Friction of the link.
    pub load_friction: FrictionTable<T>,
    /// Dry friction over the torque that the sun transmits, while the motor drives and while the motor is driven [-].
    pub losses: [T; 2],
    /// Half-backlash of the sun's meshes, one for each planet [m].
    pub half_backlash: [T; 5],
    /// Torque of a sun mesh on the sun per metre of deflection past the flank [N m/m].
    pub sun_torque: T,
    /// Torque of the gears on the link, per unit of: sun's torque, wind-up, rate of wind-up [N m].
    pub to_link: [T; 3],
    /// Torque of the weight, times the sine of the link's angle [N m].
    pub weight: T,
    /// Encoder errors of motor and link.
    pub encoders: [EncoderErrorTable<T>; 2],
}

/// Current loop: from commanded torque to torque in the air gap.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CurrentLoopTable<T: Real> {
    /// Whole periods of delay, less than [`COMMAND_QUEUE_LENGTH`].
    pub delay: u32,
    /// Share of the missing torque that is added in a period.
    pub rise: T,
    /// Share of the missing torque that is missing on average over a period.
    pub lacking: T,
    /// True over nominal torque constant.
    pub gain: T,
    /// Torque limit [N m].
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
    /// Additional dry friction at rest [N m].
    pub rise: T,
    /// Inverse of the speed at which half of this additional friction is left [s/rad].
    pub per_speed: T,
    /// Torque that stops the shaft within a period, per unit of speed [N m s/rad].
    pub stop: T,
}

/// Errors of an encoder.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct EncoderErrorTable<T: Real> {
    /// Counts per turn.
    pub turn: u32,
    /// Amplitudes of the errors once and twice per turn [2^-32 turns].
    pub errors: [T; 2],
    /// Lag of a reading per unit of speed [2^-32 turns s/rad].
    pub lag: T,
    /// 2^64 over the counts per turn, rounded up.
    pub phase: u64,
}

impl<T: Real> EncoderErrorTable<T> {
    /// Counts that the encoder reads at an angle within its turn [2^-32 turns].
    #[inline]
    pub fn counts(&self, angle: u32) -> u32 {
        (u64::from(angle).wrapping_mul(self.turn.into()) >> 32) as u32
    }

    /// Least angle at which the encoder reads the counts given, or the unit above this angle [2^-32 turns]. Two units
    /// are less than a count, so that `counts` returns the counts given.
    #[inline]
    pub fn angle(&self, counts: u32) -> u32 {
        (u64::from(counts).wrapping_mul(self.phase).wrapping_add(0xffff_ffff) >> 32) as u32
    }
}

/// Returns [`EncoderErrorTable::phase`] of an encoder with at least two counts per turn.
#[cfg(any(test, feature = "design"))]
pub(super) fn encoder_phase(counts_per_turn: u64) -> u64 {
    (1_u128 << 64).div_ceil(counts_per_turn.into()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error-free encoder with `turn` counts per turn.
    fn encoder(turn: u32) -> EncoderErrorTable<f32> {
        EncoderErrorTable { turn, errors: [0.0; 2], lag: 0.0, phase: encoder_phase(turn.into()) }
    }

    #[test]
    fn counts_survive_the_way_to_an_angle_and_back() {
        for turn in [24, 1000, 4000, 7200, 12_345, 20_000, 1_000_003, 10_000_000, (1 << 24) - 1] {
            let encoder = encoder(turn);
            for counts in (0..turn).step_by(turn as usize / 1000 + 1).chain([1, turn / 2, turn - 2, turn - 1]) {
                let angle = encoder.angle(counts);
                assert_eq!(encoder.counts(angle), counts, "{turn} counts in a turn");
                let least = (u64::from(counts) << 32).div_ceil(turn.into());
                assert!(u64::from(angle) - least <= 1, "{counts} of {turn} counts: {angle}, not {least}");
            }
            assert_eq!(encoder.counts(u32::MAX), turn - 1);
        }
    }

    #[test]
    fn counts_of_a_power_of_two_are_the_upper_bits() {
        for bits in 6..=24 {
            let encoder = encoder(1 << bits);
            for angle in (0..u32::MAX).step_by(999_983) {
                assert_eq!(encoder.counts(angle), angle >> (32 - bits));
                assert_eq!(encoder.angle(angle >> (32 - bits)), angle >> (32 - bits) << (32 - bits));
            }
        }
    }
}

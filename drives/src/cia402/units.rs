//! Units of the profile: position units at the output, thousandths of the motor's rated torque.

use core::f32::consts::TAU;

use crate::scale;
use crate::turns::Turns;

/// Factors between the fields and SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Position units in a turn of the output: the feed constant.
    pub per_turn: u32,
    /// Rated torque of the motor, at the output [N m].
    pub rated_torque: f32,
}

impl Units {
    /// Angle in position units, rounded; wraps at 32 bits.
    pub fn from_position(&self, position: Turns) -> i32 {
        let half_unit = (1_i64 << 31).checked_div(self.per_turn.into()).unwrap_or(0);
        position.plus(Turns::from_bits(half_unit)).to_counts(self.per_turn) as i32
    }

    /// Angle of a number of position units.
    pub fn to_position(&self, units: i32) -> Turns {
        Turns::from_counts(units.into(), self.per_turn)
    }

    /// Speed [rad/s] in position units a second.
    pub fn from_velocity(&self, velocity: f32) -> i32 {
        scale::round(velocity / TAU * self.per_turn as f32) as i32
    }

    /// Speed of a number of position units a second [rad/s]; also for accelerations.
    pub fn to_velocity(&self, units: f32) -> f32 {
        units / self.per_turn.max(1) as f32 * TAU
    }

    /// Torque at the output [N m] in thousandths of the rated torque.
    pub fn from_torque(&self, torque: f32) -> i16 {
        scale::round(1000.0 * torque / self.rated_torque.max(f32::MIN_POSITIVE)) as i16
    }

    /// Torque at the output of a number of thousandths of the rated torque [N m].
    pub fn to_torque(&self, thousandths: f32) -> f32 {
        thousandths / 1000.0 * self.rated_torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNITS: Units = Units { per_turn: 360_000, rated_torque: 15.0 };

    #[test]
    fn every_unit_comes_back() {
        for units in (-400_000..400_000).step_by(7).chain([i32::MIN, i32::MAX, -1, 0, 1]) {
            assert_eq!(UNITS.from_position(UNITS.to_position(units)), units);
        }
        for units in [-90_000, 0, 1, 36_000] {
            assert_eq!(UNITS.from_velocity(UNITS.to_velocity(units as f32)), units);
        }
        assert_eq!(UNITS.from_torque(UNITS.to_torque(-321.0)), -321);
    }

    #[test]
    fn values_out_of_range_give_the_ends() {
        assert_eq!(UNITS.from_velocity(f32::INFINITY), i32::MAX);
        assert_eq!(UNITS.from_velocity(f32::NAN), 0);
        assert_eq!(UNITS.from_torque(-1e9), i16::MIN);
        assert_eq!(Units { per_turn: 0, rated_torque: 0.0 }.from_torque(0.0), 0);
    }
}

//! Units of the wire, motor turns and motor N m, against those of the drive, radians and N m at the output.
//!
//! With the ratio r: w = 2 pi v / r; torque = r torque_m; a gain of torque over speed or of torque over angle is
//! r^2 / (2 pi) times the gain at the motor.

use core::f32::consts::TAU;

use crate::turns::{Ratio, Turns};

/// Conversions for a ratio.
#[derive(Debug, Clone, Copy)]
pub(super) struct Units {
    exact: Ratio,
    ratio: f32,
}

impl Units {
    pub fn new(exact: Ratio) -> Self {
        Self { exact, ratio: exact.to_f32() }
    }

    /// Angle of the output at an angle of the motor [turns].
    pub fn position(&self, turns: f32) -> Turns {
        Turns::new(turns).over(self.exact)
    }

    /// Angle of the motor at an angle of the output.
    pub fn to_position(self, position: Turns) -> Turns {
        position.times(self.exact)
    }

    /// Speed of the output [rad/s] at a speed of the motor [turns/s]; accelerations likewise.
    pub fn velocity(&self, turns: f32) -> f32 {
        TAU * turns / self.ratio
    }

    /// Speed of the motor [turns/s] at a speed of the output [rad/s].
    pub fn to_velocity(self, velocity: f32) -> f32 {
        velocity * self.ratio / TAU
    }

    /// Torque at the output [N m] of a torque of the motor [N m].
    pub fn torque(&self, torque: f32) -> f32 {
        torque * self.ratio
    }

    /// Torque of the motor [N m] for a torque at the output [N m].
    pub fn to_torque(self, torque: f32) -> f32 {
        torque / self.ratio
    }

    /// Gain at the output [N m s/rad, N m/rad] of a gain at the motor [N m/(turns/s), N m/turn]; inertias likewise.
    pub fn gain(&self, gain: f32) -> f32 {
        gain * self.ratio * self.ratio / TAU
    }

    /// Gain at the motor of a gain at the output.
    pub fn to_gain(self, gain: f32) -> f32 {
        gain * TAU / (self.ratio * self.ratio)
    }
}

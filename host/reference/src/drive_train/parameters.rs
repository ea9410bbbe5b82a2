//! Everything around the gears as plain data in SI: motor, load, sensors and disturbances, with Q1's as an example.
//! Reading them from a joint file is left to others.

use std::fmt;

use crate::joint::ReferenceError;

/// What surrounds the gears.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTrainParameters {
    /// The motor and its current loop.
    pub motor: MotorParameters,
    /// What the link carries and rubs against.
    pub load: LoadParameters,
    /// Load-dependent efficiency of the gears: output over input power while the motor drives [-].
    pub efficiency: f64,
    /// On the motor shaft.
    pub motor_encoder: EncoderParameters,
    /// On the link.
    pub output_encoder: EncoderParameters,
    /// Rate of the controller [Hz].
    pub control_rate: f64,
    /// From a command to its effect, in control periods [-].
    pub delay_periods: f64,
    /// Torques are held constant over this part of a control period, and follow angles and speeds from part to part.
    pub parts_per_period: u32,
}

/// The motor and its current loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorParameters {
    /// Commands beyond it are cut [N m].
    pub torque_limit: f64,
    /// Time constant of the first-order current loop; zero for none [s].
    pub current_lag: f64,
    /// True over nominal torque constant, less 1 [-].
    pub torque_constant_error_ratio: f64,
    /// Torque noise, RMS over the torque; drawn anew each control period [-].
    pub torque_noise_ratio: f64,
    /// Bearings and seals.
    pub friction: FrictionParameters,
    /// Amplitude of the cogging torque [N m].
    pub cogging_torque: f64,
    /// Periods of the cogging torque in one motor turn.
    pub cogging_periods_per_turn: u32,
}

/// What the link carries and rubs against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadParameters {
    /// Bearing and seal of the output.
    pub friction: FrictionParameters,
    /// Weight times lever of the link: it brakes by this times sin(link angle) [N m].
    pub gravity_torque: f64,
}

/// Dry and viscous friction at one shaft.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrictionParameters {
    /// Dry friction at speed [N m].
    pub coulomb: f64,
    /// Viscous friction [N m s/rad].
    pub viscous: f64,
    /// Dry friction at rest over the one at speed, less 1 [-].
    pub stribeck_rise_ratio: f64,
    /// Speed at which the rise has fallen to 1/e [rad/s].
    pub stribeck_speed: f64,
}

/// An absolute encoder that counts its turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderParameters {
    /// 2^bits counts a turn.
    pub bits: u32,
    /// Amplitude of the error that comes once a turn [rad].
    pub once_per_turn_error: f64,
    /// Its phase at angle zero [rad].
    pub once_per_turn_phase: f64,
    /// Amplitude of the error that comes twice a turn [rad].
    pub twice_per_turn_error: f64,
    /// Its phase at angle zero [rad].
    pub twice_per_turn_phase: f64,
    /// How old a reading is [s].
    pub skew: f64,
}

/// Why a drive train cannot run.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveTrainError {
    /// A parameter is out of range.
    OutOfRange {
        /// Which one.
        quantity: &'static str,
        /// What it was.
        value: f64,
        /// What it must be.
        must_be: &'static str,
    },
    /// The joint within cannot be followed.
    Joint(ReferenceError),
}

impl fmt::Display for DriveTrainError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { quantity, value, must_be } => {
                write!(formatter, "{quantity} is {value}; it must be {must_be}")
            }
            Self::Joint(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for DriveTrainError {}

impl From<ReferenceError> for DriveTrainError {
    fn from(error: ReferenceError) -> Self {
        Self::Joint(error)
    }
}

impl EncoderParameters {
    /// Right up to its resolution.
    pub fn ideal(bits: u32) -> Self {
        Self {
            bits,
            once_per_turn_error: 0.0,
            once_per_turn_phase: 0.0,
            twice_per_turn_error: 0.0,
            twice_per_turn_phase: 0.0,
            skew: 0.0,
        }
    }
}

impl DriveTrainParameters {
    /// No friction, lag, noise, gravity, delay or sensor error; 10 kHz, encoders of 18 bits.
    pub fn ideal() -> Self {
        Self {
            motor: MotorParameters {
                torque_limit: f64::INFINITY,
                current_lag: 0.0,
                torque_constant_error_ratio: 0.0,
                torque_noise_ratio: 0.0,
                friction: FrictionParameters::default(),
                cogging_torque: 0.0,
                cogging_periods_per_turn: 1,
            },
            load: LoadParameters { friction: FrictionParameters::default(), gravity_torque: 0.0 },
            efficiency: 1.0,
            motor_encoder: EncoderParameters::ideal(18),
            output_encoder: EncoderParameters::ideal(18),
            control_rate: 10e3,
            delay_periods: 0.0,
            parts_per_period: 10,
        }
    }

    /// Around joint Q1. Assumed by this module: the number of cogging periods and the Stribeck speed.
    pub fn q1() -> Self {
        Self {
            motor: MotorParameters {
                torque_limit: 2.5,
                current_lag: 0.2e-3,
                torque_constant_error_ratio: 0.03,
                torque_noise_ratio: 0.015,
                friction: FrictionParameters { coulomb: 0.03, viscous: 2e-4, ..FrictionParameters::default() },
                cogging_torque: 0.02,
                cogging_periods_per_turn: 84,
            },
            load: LoadParameters {
                friction: FrictionParameters {
                    coulomb: 0.3,
                    viscous: 0.1,
                    stribeck_rise_ratio: 0.2,
                    stribeck_speed: 0.05,
                },
                gravity_torque: 6.0,
            },
            efficiency: 0.97,
            motor_encoder: EncoderParameters {
                once_per_turn_error: 0.1_f64.to_radians(),
                twice_per_turn_error: 0.1_f64.to_radians(),
                ..EncoderParameters::ideal(14)
            },
            output_encoder: EncoderParameters {
                once_per_turn_error: 0.02_f64.to_radians(),
                skew: 50e-6,
                ..EncoderParameters::ideal(17)
            },
            delay_periods: 1.0,
            ..Self::ideal()
        }
    }

    pub(super) fn check(&self) -> Result<(), DriveTrainError> {
        let must = |quantity, value: f64, holds: bool, must_be| {
            if holds { Ok(()) } else { Err(DriveTrainError::OutOfRange { quantity, value, must_be }) }
        };
        let not_negative = |quantity, value: f64| {
            must(quantity, value, value >= 0.0 && value.is_finite(), "zero or positive, and finite")
        };
        must("control rate", self.control_rate, self.control_rate > 0.0 && self.control_rate.is_finite(), "positive")?;
        must("parts per period", self.parts_per_period.into(), self.parts_per_period > 0, "at least 1")?;
        must("efficiency", self.efficiency, self.efficiency > 0.0 && self.efficiency <= 1.0, "above 0 and at most 1")?;
        must("motor torque limit", self.motor.torque_limit, self.motor.torque_limit >= 0.0, "zero or positive")?;
        not_negative("delay in periods", self.delay_periods)?;
        not_negative("current lag", self.motor.current_lag)?;
        not_negative("torque noise ratio", self.motor.torque_noise_ratio)?;
        for friction in [&self.motor.friction, &self.load.friction] {
            not_negative("dry friction", friction.coulomb)?;
            not_negative("viscous friction", friction.viscous)?;
            not_negative("Stribeck rise ratio", friction.stribeck_rise_ratio)?;
            not_negative("Stribeck speed", friction.stribeck_speed)?;
        }
        for encoder in [&self.motor_encoder, &self.output_encoder] {
            must("encoder bits", encoder.bits.into(), (1..=30).contains(&encoder.bits), "from 1 to 30")?;
            not_negative("encoder skew", encoder.skew)?;
        }
        Ok(())
    }
}

//! What a drive train is made of, as plain data in SI, with Q1's as an example: its surroundings as a data sheet tells
//! them, and what only the truth has.

use std::fmt;

use parameters::{AbsoluteEncoder, Friction, Surroundings};

use crate::joint::ReferenceError;

/// What surrounds the gears, and what no data sheet tells of it.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTrainParameters {
    /// As a data sheet has it; here it is the truth.
    pub surroundings: Surroundings,
    /// Of the motor's encoder.
    pub motor_error_phases: ErrorPhases,
    /// Of the output encoder.
    pub output_error_phases: ErrorPhases,
    /// Torques are held constant over this part of a control period, and follow angles and speeds from part to part.
    pub parts_per_period: u32,
}

/// How an encoder was mounted: the phases of its errors at angle zero [rad].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorPhases {
    /// Of the error that comes once a turn [rad].
    pub once_per_turn: f64,
    /// Of the error that comes twice a turn [rad].
    pub twice_per_turn: f64,
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

impl From<Surroundings> for DriveTrainParameters {
    /// Phases of encoder errors at zero, ten parts in a control period.
    fn from(surroundings: Surroundings) -> Self {
        Self {
            surroundings,
            motor_error_phases: ErrorPhases::default(),
            output_error_phases: ErrorPhases::default(),
            parts_per_period: 10,
        }
    }
}

impl DriveTrainParameters {
    /// No friction, lag, noise, gravity, delay or sensor error; 10 kHz, encoders of 18 bits.
    pub fn ideal() -> Self {
        Surroundings::ideal().into()
    }

    /// Around joint Q1. Assumed by this module: the number of cogging periods and the Stribeck speed.
    pub fn q1() -> Self {
        Surroundings {
            delay: 1.0,
            current_lag: 0.2e-3,
            torque_limit: 2.5,
            torque_noise_ratio: 0.015,
            torque_constant_error_ratio: 0.03,
            cogging_torque: 0.02,
            cogging_periods_per_turn: 84,
            motor_friction: Friction { coulomb: 0.03, viscous: 2e-4, ..Friction::default() },
            load_friction: Friction { coulomb: 0.3, viscous: 0.1, stribeck_rise_ratio: 0.2, stribeck_speed: 0.05 },
            efficiency: 0.97,
            gravity_torque: 6.0,
            motor_encoder: AbsoluteEncoder {
                once_per_turn_error: 0.1_f64.to_radians(),
                twice_per_turn_error: 0.1_f64.to_radians(),
                ..AbsoluteEncoder::ideal(14)
            },
            output_encoder: AbsoluteEncoder {
                once_per_turn_error: 0.02_f64.to_radians(),
                skew: 50e-6,
                ..AbsoluteEncoder::ideal(17)
            },
            ..Surroundings::ideal()
        }
        .into()
    }

    pub(super) fn check(&self) -> Result<(), DriveTrainError> {
        let around = &self.surroundings;
        let must = |quantity, value: f64, holds: bool, must_be| {
            if holds { Ok(()) } else { Err(DriveTrainError::OutOfRange { quantity, value, must_be }) }
        };
        let not_negative = |quantity, value: f64| {
            must(quantity, value, value >= 0.0 && value.is_finite(), "zero or positive, and finite")
        };
        must("control rate", around.control_rate.into(), around.control_rate > 0, "positive")?;
        must("parts per period", self.parts_per_period.into(), self.parts_per_period > 0, "at least 1")?;
        let efficiency = around.efficiency;
        must("efficiency", efficiency, efficiency > 0.0 && efficiency <= 1.0, "above 0 and at most 1")?;
        must("motor torque limit", around.torque_limit, around.torque_limit >= 0.0, "zero or positive")?;
        not_negative("delay in periods", around.delay)?;
        not_negative("current lag", around.current_lag)?;
        not_negative("torque noise ratio", around.torque_noise_ratio)?;
        for friction in [&around.motor_friction, &around.load_friction] {
            not_negative("dry friction", friction.coulomb)?;
            not_negative("viscous friction", friction.viscous)?;
            not_negative("Stribeck rise ratio", friction.stribeck_rise_ratio)?;
            not_negative("Stribeck speed", friction.stribeck_speed)?;
        }
        for encoder in [&around.motor_encoder, &around.output_encoder] {
            must("encoder bits", encoder.bits.into(), (1..=30).contains(&encoder.bits), "from 1 to 30")?;
            not_negative("encoder skew", encoder.skew)?;
        }
        Ok(())
    }
}

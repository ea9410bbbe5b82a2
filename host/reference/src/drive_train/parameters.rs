//! Parameters of a drive train as plain data in SI, with those of Q1 as an example: data-sheet values of the
//! surroundings, and quantities that no data sheet states.

use std::fmt;

use parameters::{AbsoluteEncoder, Friction, Surroundings};

use super::bristles::Bristles;
use crate::joint::ReferenceError;

/// Parameters of a drive train.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTrainParameters {
    /// Data-sheet values, true in the simulation.
    pub surroundings: Surroundings,
    /// Error phases of the motor encoder.
    pub motor_error_phases: ErrorPhases,
    /// Error phases of the output encoder.
    pub output_error_phases: ErrorPhases,
    /// Phases of further effects.
    pub effect_phases: EffectPhases,
    /// Parts of a control period; torques are constant within a part and follow angles and speeds from part to part.
    pub parts_per_period: u32,
}

/// Mounting of an encoder: phases of its errors at angle zero [rad].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorPhases {
    /// Phase of the once-per-turn error [rad].
    pub once_per_turn: f64,
    /// Phase of the twice-per-turn error [rad].
    pub twice_per_turn: f64,
}

/// Phases at angle zero that no data sheet states [rad].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EffectPhases {
    /// Phases of the motor encoder's error within a scale period: first and second harmonic.
    pub motor_subdivision: [f64; 2],
    /// Phases of the output encoder's error within a scale period: first and second harmonic.
    pub output_subdivision: [f64; 2],
    /// Phases of the backlash variation around the turn: link, motor.
    pub width: [f64; 2],
}

/// Reason for refusing or stopping a drive train.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveTrainError {
    /// A parameter is out of range.
    OutOfRange {
        /// Name of the parameter.
        quantity: &'static str,
        /// Rejected value.
        value: f64,
        /// Required range.
        must_be: &'static str,
    },
    /// The joint model failed.
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
    /// Parameters with all error phases at zero and ten parts per control period.
    fn from(surroundings: Surroundings) -> Self {
        Self {
            surroundings,
            motor_error_phases: ErrorPhases::default(),
            output_error_phases: ErrorPhases::default(),
            effect_phases: EffectPhases::default(),
            parts_per_period: 10,
        }
    }
}

impl DriveTrainParameters {
    /// Parameters without friction, lag, noise, gravity, delay or sensor error; 10 kHz, 18-bit encoders.
    pub fn ideal() -> Self {
        Surroundings::ideal().into()
    }

    /// Parameters around joint Q1. Assumed here: number of cogging periods and Stribeck speed.
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
            let turn = encoder.counts_per_turn;
            must("counts in a turn of an encoder", turn as f64, (2..=1 << 30).contains(&turn), "from 2 to 2^30")?;
            not_negative("encoder skew", encoder.skew)?;
            not_negative("jitter of the age of an encoder's readings", encoder.age_jitter)?;
            not_negative("noise of an encoder in counts", encoder.noise_counts)?;
            let share = encoder.missing_share;
            must("share of missing readings", share, (0.0..=1.0).contains(&share), "from 0 to 1")?;
            for amplitude in [encoder.subdivision.first, encoder.subdivision.second] {
                not_negative("sub-divisional error of an encoder", amplitude)?;
            }
        }
        self.check_effects()
    }

    fn check_effects(&self) -> Result<(), DriveTrainError> {
        let around = &self.surroundings;
        let below_one =
            |quantity, value: f64| must(quantity, value, (0.0..1.0).contains(&value), "at least 0 and less than 1");
        let payload = &around.payload;
        below_one("share of the payload", payload.inertia_share)?;
        below_one("damping ratio of the payload", payload.damping_ratio)?;
        if payload.inertia_share > 0.0 {
            positive("frequency of the payload", payload.frequency)?;
        }
        positive("ratio of the payload step", around.payload_step.ratio)?;
        not_negative("time of the payload step", around.payload_step.time)?;
        below_one("share of the stiffness with hysteresis", around.hysteresis.stiffness_share)?;
        if around.hysteresis.stiffness_share > 0.0 {
            positive("torque of the hysteresis", around.hysteresis.torque)?;
        }
        not_negative("presliding of the motor", around.presliding.motor)?;
        not_negative("presliding of the link", around.presliding.load)?;
        not_negative("variation of the backlash once a turn of the link", around.width.per_link_turn)?;
        not_negative("variation of the backlash once a turn of the motor", around.width.per_motor_turn)?;
        below_one("variation of the backlash", around.width.per_link_turn + around.width.per_motor_turn)?;
        for drift in [around.drift.friction, around.drift.width] {
            must("drift a second", drift, drift.is_finite(), "finite")?;
        }
        let errors = &around.torque_errors;
        below_one("ripple of the torque", errors.ripple_ratio)?;
        below_one("loss of torque at the limit", errors.saturation_ratio)?;
        below_one("step of the torque over the limit", errors.resolution_ratio)?;
        if errors.saturation_ratio + errors.resolution_ratio > 0.0 {
            let limit = around.torque_limit;
            let must_be = "finite and positive: saturation and steps of the torque are parts of it";
            must("motor torque limit", limit, limit.is_finite() && limit > 0.0, must_be)?;
        }
        let jitter = around.control_jitter_ratio;
        must("jitter of the control loop", jitter, (0.0..=0.5).contains(&jitter), "from 0 to 0.5")
    }

    /// Refuses bristles that parts of this length [s] cannot follow, for the inertias of motor and link [kg m^2].
    pub(super) fn check_presliding(&self, inertias: [f64; 2], part: f64) -> Result<(), DriveTrainError> {
        let around = &self.surroundings;
        let shafts = [
            ("presliding of the motor", around.presliding.motor, &around.motor_friction),
            ("presliding of the link", around.presliding.load, &around.load_friction),
        ];
        shafts.into_iter().zip(inertias).try_for_each(|((quantity, value, friction), inertia)| {
            let holds = value == 0.0 || value >= Bristles::least_presliding(friction, inertia, part);
            must(
                quantity,
                value,
                holds,
                "zero, or so large that the shaft swings on its bristles slower than a part of time",
            )
        })
    }
}

fn must(quantity: &'static str, value: f64, holds: bool, must_be: &'static str) -> Result<(), DriveTrainError> {
    if holds { Ok(()) } else { Err(DriveTrainError::OutOfRange { quantity, value, must_be }) }
}

fn not_negative(quantity: &'static str, value: f64) -> Result<(), DriveTrainError> {
    must(quantity, value, value >= 0.0 && value.is_finite(), "zero or positive, and finite")
}

fn positive(quantity: &'static str, value: f64) -> Result<(), DriveTrainError> {
    must(quantity, value, value > 0.0 && value.is_finite(), "positive and finite")
}

//! Surroundings of the gears of a joint, as plain data in SI: motor with current loop, friction, weight, encoders, and
//! rate of the controller.

use crate::effects::{
    Drift, Hysteresis, Payload, PayloadStep, Presliding, SubdivisionalError, TorqueErrors, WidthVariation,
};

/// Default of the largest motor speed [rad/s]: 11,500 revolutions per minute, which few servo motors exceed.
pub const DEFAULT_SPEED_LIMIT: f64 = 1200.0;

/// Surroundings of the gears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings {
    /// Control periods per second [Hz].
    pub control_rate: u32,
    /// Delay from measurement to torque [control periods].
    pub delay: f64,
    /// Time constant of the current loop, which follows the delay [s].
    pub current_lag: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Largest speed of the motor [rad/s].
    pub speed_limit: f64,
    /// Standard deviation of the torque noise over the torque [-].
    pub torque_noise_ratio: f64,
    /// Ratio of true to nominal torque constant, minus 1 [-].
    pub torque_constant_error_ratio: f64,
    /// Amplitude of the cogging torque [N m].
    pub cogging_torque: f64,
    /// Periods of the cogging torque in a turn of the motor.
    pub cogging_periods_per_turn: u32,
    /// Friction at the motor.
    pub motor_friction: Friction,
    /// Friction at the link.
    pub load_friction: Friction,
    /// Efficiency of the gears while the motor drives, load-dependent losses only [-].
    pub efficiency: f64,
    /// Amplitude of the link's gravity torque, which brakes by the amplitude times sin(link angle) [N m].
    pub gravity_torque: f64,
    /// Encoder on the motor.
    pub motor_encoder: AbsoluteEncoder,
    /// Encoder on the link.
    pub output_encoder: AbsoluteEncoder,
    /// Part of the link's inertia on a spring.
    pub payload: Payload,
    /// Change of the link's inertia and weight.
    pub payload_step: PayloadStep,
    /// Displacement of the shafts before the full dry friction acts.
    pub presliding: Presliding,
    /// Slip of the stiffness between carrier and link.
    pub hysteresis: Hysteresis,
    /// Variation of the backlash around a turn.
    pub width: WidthVariation,
    /// Drift of friction and backlash over time.
    pub drift: Drift,
    /// Ripple, steps and saturation of the motor's torque.
    pub torque_errors: TorqueErrors,
    /// Largest random delay of the start of a control period, over the period [-].
    pub control_jitter_ratio: f64,
}

impl Surroundings {
    /// Creates ideal surroundings: no friction, lag, noise, gravity, delay or sensor error, no torque limit, no loss;
    /// 10 kHz, encoders of 18 bits.
    pub fn ideal() -> Self {
        Self {
            control_rate: 10_000,
            delay: 0.0,
            current_lag: 0.0,
            torque_limit: f64::INFINITY,
            speed_limit: DEFAULT_SPEED_LIMIT,
            torque_noise_ratio: 0.0,
            torque_constant_error_ratio: 0.0,
            cogging_torque: 0.0,
            cogging_periods_per_turn: 1,
            motor_friction: Friction::default(),
            load_friction: Friction::default(),
            efficiency: 1.0,
            gravity_torque: 0.0,
            motor_encoder: AbsoluteEncoder::ideal(18),
            output_encoder: AbsoluteEncoder::ideal(18),
            payload: Payload::default(),
            payload_step: PayloadStep::default(),
            presliding: Presliding::default(),
            hysteresis: Hysteresis::default(),
            width: WidthVariation::default(),
            drift: Drift::default(),
            torque_errors: TorqueErrors::default(),
            control_jitter_ratio: 0.0,
        }
    }
}

/// Dry and viscous friction of a shaft.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Friction {
    /// Dry friction at speed [N m].
    pub coulomb: f64,
    /// Viscous friction [N m s/rad].
    pub viscous: f64,
    /// Ratio of dry friction at rest to dry friction at speed, minus 1 [-].
    pub stribeck_rise_ratio: f64,
    /// Speed at which the rise has fallen to 1/e [rad/s].
    pub stribeck_speed: f64,
}

/// Absolute single-turn encoder.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AbsoluteEncoder {
    /// Counts in a turn.
    pub counts_per_turn: u64,
    /// Amplitude of the error once per turn [rad].
    pub once_per_turn_error: f64,
    /// Amplitude of the error twice per turn [rad].
    pub twice_per_turn_error: f64,
    /// Age of a reading beyond its time stamp [s].
    pub skew: f64,
    /// Largest additional random age of a reading [s].
    pub age_jitter: f64,
    /// Standard deviation of a reading's noise before rounding [counts].
    pub noise_counts: f64,
    /// Error within one period of the scale.
    pub subdivision: SubdivisionalError,
    /// Fraction of control periods without a reading [-].
    pub missing_share: f64,
}

impl AbsoluteEncoder {
    /// Creates an encoder of 2^bits counts per turn, without errors other than rounding.
    pub fn ideal(bits: u32) -> Self {
        Self { counts_per_turn: Self::counts_of_bits(bits), ..Self::default() }
    }

    /// Returns the counts per turn of an encoder of `bits` bits.
    ///
    /// ```
    /// use parameters::AbsoluteEncoder;
    /// assert_eq!(AbsoluteEncoder::counts_of_bits(14), 16_384);
    /// assert_eq!(AbsoluteEncoder::ideal(14).bits(), Some(14));
    /// let incremental = AbsoluteEncoder { counts_per_turn: 4000, ..AbsoluteEncoder::default() };
    /// assert_eq!(incremental.bits(), None);
    /// ```
    pub fn counts_of_bits(bits: u32) -> u64 {
        1_u64.checked_shl(bits).unwrap_or(u64::MAX)
    }

    /// Returns the resolution in bits; `None` if the counts per turn are not a power of two.
    pub fn bits(&self) -> Option<u32> {
        self.counts_per_turn.is_power_of_two().then(|| self.counts_per_turn.trailing_zeros())
    }
}

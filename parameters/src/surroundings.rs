//! What surrounds the gears of a joint, as plain data in SI: motor with its current loop, frictions, weight, encoders,
//! and the controller's rate.

use crate::effects::{
    Drift, Hysteresis, Payload, PayloadStep, Presliding, SubdivisionalError, TorqueErrors, WidthVariation,
};

/// Largest speed of a motor whose data sheet is silent [rad/s]: 11,500 revolutions a minute, which few servo motors exceed.
pub const DEFAULT_SPEED_LIMIT: f64 = 1200.0;

/// Everything around the gears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings {
    /// Periods of the controller a second [Hz].
    pub control_rate: u32,
    /// From commanding a torque to its first effect [control periods].
    pub delay: f64,
    /// Time constant of the current loop after that [s].
    pub current_lag: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Largest speed of the motor [rad/s].
    pub speed_limit: f64,
    /// Torque noise over the torque, standard deviation [-].
    pub torque_noise_ratio: f64,
    /// True over nominal torque constant, less 1 [-].
    pub torque_constant_error_ratio: f64,
    /// Amplitude of the cogging torque [N m].
    pub cogging_torque: f64,
    /// Its periods in a turn of the motor.
    pub cogging_periods_per_turn: u32,
    /// At the motor.
    pub motor_friction: Friction,
    /// At the link.
    pub load_friction: Friction,
    /// Efficiency of the gears while the motor drives, losses in proportion to the load [-].
    pub efficiency: f64,
    /// Weight times lever of the link: it brakes by this times the sine of the link's angle [N m].
    pub gravity_torque: f64,
    /// On the motor.
    pub motor_encoder: AbsoluteEncoder,
    /// On the link.
    pub output_encoder: AbsoluteEncoder,
    /// Part of the link that swings on a spring.
    pub payload: Payload,
    /// Change of the link's inertia and weight.
    pub payload_step: PayloadStep,
    /// Creep of the shafts below their dry friction.
    pub presliding: Presliding,
    /// Slip of the stiffness between carrier and link.
    pub hysteresis: Hysteresis,
    /// Backlash around the turn.
    pub width: WidthVariation,
    /// Friction and backlash over time.
    pub drift: Drift,
    /// Ripple, steps and saturation of the motor's torque.
    pub torque_errors: TorqueErrors,
    /// Longest delay of a control period's start over the period; every period draws its own [-].
    pub control_jitter_ratio: f64,
}

impl Surroundings {
    /// No friction, lag, noise, gravity, delay or sensor error, and a motor without a limit; 10 kHz, encoders of 18 bits.
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
    /// Dry friction at rest over the one at speed, less 1 [-].
    pub stribeck_rise_ratio: f64,
    /// Speed at which that rise has fallen to 1/e [rad/s].
    pub stribeck_speed: f64,
}

/// An absolute encoder of one turn.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AbsoluteEncoder {
    /// Counts in a turn.
    pub counts_per_turn: u64,
    /// Amplitude of the error that comes once a turn [rad].
    pub once_per_turn_error: f64,
    /// Amplitude of the error that comes twice a turn [rad].
    pub twice_per_turn_error: f64,
    /// How old a reading is beyond what its time says [s].
    pub skew: f64,
    /// Further age of a reading, from 0 to this; every reading draws its own [s].
    pub age_jitter: f64,
    /// Standard deviation of a reading's noise, before it is rounded to a count [counts].
    pub noise_counts: f64,
    /// Error within a period of the scale.
    pub subdivision: SubdivisionalError,
    /// Share of the control periods without a reading [-].
    pub missing_share: f64,
}

impl AbsoluteEncoder {
    /// Right up to its resolution of 2^bits counts a turn.
    pub fn ideal(bits: u32) -> Self {
        Self { counts_per_turn: Self::counts_of_bits(bits), ..Self::default() }
    }

    /// Counts in a turn of an encoder of so many bits.
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

    /// Resolution in bits; `None` where the counts in a turn are no power of two.
    pub fn bits(&self) -> Option<u32> {
        self.counts_per_turn.is_power_of_two().then(|| self.counts_per_turn.trailing_zeros())
    }
}

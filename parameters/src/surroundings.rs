//! What surrounds the gears of a joint, as plain data in SI: motor with its current loop, frictions, weight, encoders,
//! and the controller's rate.

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
}

impl Surroundings {
    /// No friction, lag, noise, gravity, delay or sensor error, and a motor without a limit; 10 kHz, encoders of 18 bits.
    pub fn ideal() -> Self {
        Self {
            control_rate: 10_000,
            delay: 0.0,
            current_lag: 0.0,
            torque_limit: f64::INFINITY,
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
    /// 2^bits counts in a turn.
    pub bits: u32,
    /// Amplitude of the error that comes once a turn [rad].
    pub once_per_turn_error: f64,
    /// Amplitude of the error that comes twice a turn [rad].
    pub twice_per_turn_error: f64,
    /// How old a reading is beyond what its time says [s].
    pub skew: f64,
}

impl AbsoluteEncoder {
    /// Right up to its resolution of 2^bits counts a turn.
    pub fn ideal(bits: u32) -> Self {
        Self { bits, once_per_turn_error: 0.0, twice_per_turn_error: 0.0, skew: 0.0 }
    }
}

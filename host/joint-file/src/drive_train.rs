//! Reads `[drive_train]`: what surrounds the gears in a real joint, as plain data in SI. The model of it is the
//! reference's business; the fixed step never sees any of this.

use crate::section::Section;

/// Motor, load and sensors around the gears. The default is ideal: no friction, no lag, no noise, perfect encoders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveTrain {
    /// Coulomb friction of the motor [N m].
    pub motor_coulomb_friction: f64,
    /// Viscous friction of the motor [N m s/rad].
    pub motor_viscous_friction: f64,
    /// Amplitude of the cogging torque [N m].
    pub cogging_torque: f64,
    /// Periods of the cogging torque in one motor turn.
    pub cogging_periods_per_turn: u32,
    /// Coulomb friction at the link [N m].
    pub load_coulomb_friction: f64,
    /// Stribeck rise: friction at rest over Coulomb friction, less 1 [-].
    pub load_stribeck_rise_ratio: f64,
    /// Link speed at which the Stribeck rise has decayed to 1/e [rad/s].
    pub load_stribeck_speed: f64,
    /// Viscous friction at the link [N m s/rad].
    pub load_viscous_friction: f64,
    /// Load-dependent efficiency of the gears [-].
    pub efficiency: f64,
    /// Torque of the link's weight, times sin(link angle) [N m].
    pub gravity_torque: f64,
    /// Time constant of the current loop [s].
    pub current_lag: f64,
    /// Torque noise, rms over the torque [-].
    pub torque_noise_ratio: f64,
    /// True over nominal torque constant, less 1 [-].
    pub torque_constant_error_ratio: f64,
    /// Rate of the controller [Hz].
    pub control_rate: f64,
    /// From measuring to acting, in control periods [-].
    pub control_delay_periods: f64,
    /// On the motor shaft.
    pub motor_encoder: Encoder,
    /// On the link.
    pub output_encoder: Encoder,
}

/// An absolute encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    /// Resolution: 2^bits counts a turn.
    pub bits: u32,
    /// Amplitude of the error that comes once a turn [rad].
    pub once_per_turn_error: f64,
    /// Amplitude of the error that comes twice a turn [rad].
    pub twice_per_turn_error: f64,
    /// How late a reading is [s].
    pub skew: f64,
}

impl Default for DriveTrain {
    fn default() -> Self {
        Self {
            motor_coulomb_friction: 0.0,
            motor_viscous_friction: 0.0,
            cogging_torque: 0.0,
            cogging_periods_per_turn: 1,
            load_coulomb_friction: 0.0,
            load_stribeck_rise_ratio: 0.0,
            load_stribeck_speed: 0.05,
            load_viscous_friction: 0.0,
            efficiency: 1.0,
            gravity_torque: 0.0,
            current_lag: 0.0,
            torque_noise_ratio: 0.0,
            torque_constant_error_ratio: 0.0,
            control_rate: 10e3,
            control_delay_periods: 0.0,
            motor_encoder: Encoder::default(),
            output_encoder: Encoder::default(),
        }
    }
}

impl Default for Encoder {
    /// 18 bits and no error.
    fn default() -> Self {
        Self { bits: 18, once_per_turn_error: 0.0, twice_per_turn_error: 0.0, skew: 0.0 }
    }
}

/// The drive train. Keys left out are ideal, and so are wrong ones once they have been noted.
pub(crate) fn read(section: &Section<'_>) -> DriveTrain {
    let ideal = DriveTrain::default();
    let number = |key: &str, default: f64| section.number(key).unwrap_or(default);
    DriveTrain {
        motor_coulomb_friction: number("motor_coulomb_friction_N_m", ideal.motor_coulomb_friction),
        motor_viscous_friction: number("motor_viscous_friction_N_m_s_per_rad", ideal.motor_viscous_friction),
        cogging_torque: number("cogging_torque_N_m", ideal.cogging_torque),
        cogging_periods_per_turn: section.whole("cogging_periods_per_turn").unwrap_or(ideal.cogging_periods_per_turn),
        load_coulomb_friction: number("load_coulomb_friction_N_m", ideal.load_coulomb_friction),
        load_stribeck_rise_ratio: number("load_stribeck_rise_ratio", ideal.load_stribeck_rise_ratio),
        load_stribeck_speed: number("load_stribeck_speed_rad_per_s", ideal.load_stribeck_speed),
        load_viscous_friction: number("load_viscous_friction_N_m_s_per_rad", ideal.load_viscous_friction),
        efficiency: number("efficiency", ideal.efficiency),
        gravity_torque: number("gravity_torque_N_m", ideal.gravity_torque),
        current_lag: number("current_lag_ms", ideal.current_lag),
        torque_noise_ratio: number("torque_noise_ratio", ideal.torque_noise_ratio),
        torque_constant_error_ratio: number("torque_constant_error_ratio", ideal.torque_constant_error_ratio),
        control_rate: number("control_rate_Hz", ideal.control_rate),
        control_delay_periods: number("control_delay_periods", ideal.control_delay_periods),
        motor_encoder: encoder(section, "motor_encoder"),
        output_encoder: encoder(section, "output_encoder"),
    }
}

fn encoder(section: &Section<'_>, name: &str) -> Encoder {
    let ideal = Encoder::default();
    let Some(section) = section.section(name, "encoder") else { return ideal };
    let number = |key: &str| section.number(key).unwrap_or(0.0);
    Encoder {
        bits: section.required_whole("bits").unwrap_or(ideal.bits),
        once_per_turn_error: number("once_per_turn_error_deg"),
        twice_per_turn_error: number("twice_per_turn_error_deg"),
        skew: number("skew_us"),
    }
}

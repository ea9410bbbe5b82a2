//! Tables of the observer: from joint, encoders and how much is known beforehand to flows and gains. What the observer
//! does with them is left to `realtime::observer`.

use crate::error::DesignError;
use crate::joint::JointParameters;
use crate::real::Real;
use crate::tables::observer::ObserverTables;

/// An encoder as its data sheet has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderSettings {
    /// Counts in one turn of its shaft; any number.
    pub counts_per_turn: u32,
    /// Raw counts run from 0 to this less 1 and start again; 0 stands for 2^32. The number of counts in a turn for a
    /// single-turn absolute encoder.
    pub wraps_at: u32,
    /// Standard deviation to expect of its once- and of its twice-per-turn error; zero if there is none [rad].
    pub harmonic_error: f64,
}

/// What the observer is designed from besides the joint. The joint's own half-backlash and compliance are guesses to
/// start from.
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverSettings {
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Ticks a second of the clock of all moments [Hz].
    pub clock_rate: u32,
    /// Encoder on the motor.
    pub motor_encoder: EncoderSettings,
    /// Encoder on the link, if there is one.
    pub output_encoder: Option<EncoderSettings>,
    /// From commanding a torque to its first effect [control periods].
    pub torque_delay: f64,
    /// Time constant of the current loop after that [s].
    pub torque_lag: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Torque noise over the torque, standard deviation [-].
    pub torque_noise_ratio: f64,
    /// Standard deviation of the motor's friction, cogging and bias together [N m].
    pub torque_uncertainty: f64,
    /// Standard deviation of the half-backlash guess, relative to it [-].
    pub backlash_uncertainty: f64,
    /// Standard deviation of the compliance guess, relative to it [-].
    pub compliance_uncertainty: f64,
    /// Standard deviation of the skew between the encoders' readings [s].
    pub skew_uncertainty: f64,
}

/// Tables of the observer.
pub fn design_observer<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
) -> Result<ObserverTables<T>, DesignError> {
    let _ = joint;
    Ok(ObserverTables {
        control_rate: settings.control_rate,
        period: T::from_f64(1.0 / f64::from(settings.control_rate)),
    })
}

//! What a compensation is designed from besides the joint, and which settings are refused.

use crate::gears::design::DesignError;
use crate::observer::design::NO_LIMIT;
use parameters::Surroundings;

/// What the compensation is designed from besides the joint. The joint's own half-backlash is a guess to start from.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensationSettings {
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Bandwidth of the motor controller: its three poles [rad/s].
    pub bandwidth: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Most that the teeth shall pass on in position mode, referred to the link [N m]; if left out, what the motor
    /// gives at its limit, but no more than twice the rated torque.
    pub peak_torque: Option<f64>,
    /// Efficiency of the gears as far as losses grow with the torque passed on: output over input power while the motor
    /// drives.
    pub efficiency: f64,
    /// Periods of the motor's cogging in a turn of the motor.
    pub cogging_periods: u32,
    /// From commanding a torque to its first effect [control periods].
    pub torque_delay: f64,
    /// Time constant of the current loop after that [s].
    pub torque_lag: f64,
    /// Dry friction of the motor, as far as it is known, at the motor [N m].
    pub motor_friction: f64,
    /// That of the link [N m].
    pub load_friction: f64,
}

/// Refuses settings that no gain can be made from.
pub(super) fn check(settings: &CompensationSettings) -> Result<(), DesignError> {
    let must = |what: &'static str, given: f64, holds: bool, must_be: &'static str| {
        if holds && given.is_finite() { Ok(()) } else { Err(DesignError::OutOfRange { what, given, must_be }) }
    };
    let CompensationSettings { bandwidth, torque_limit, torque_delay, torque_lag, .. } = *settings;
    let rate = f64::from(settings.control_rate);
    must("control rate", rate, rate > 0.0, "positive")?;
    must("bandwidth", bandwidth, bandwidth > 0.0, "positive")?;
    must("motor torque limit", torque_limit, torque_limit > 0.0, "positive")?;
    if let Some(peak) = settings.peak_torque {
        must("peak torque", peak, peak > 0.0, "positive")?;
    }
    must(
        "efficiency",
        settings.efficiency,
        settings.efficiency > 0.0 && settings.efficiency <= 1.0,
        "above 0, at most 1",
    )?;
    must("torque delay", torque_delay, torque_delay >= 0.0, "zero or positive")?;
    must("torque lag", torque_lag, torque_lag >= 0.0, "zero or positive")?;
    for (what, friction) in [("motor friction", settings.motor_friction), ("load friction", settings.load_friction)] {
        must(what, friction, friction >= 0.0, "zero or positive")?;
    }
    Ok(())
}

/// Settings of a compensation for these surroundings, at a bandwidth [rad/s].
pub fn compensation_settings(of: &Surroundings, bandwidth: f64) -> CompensationSettings {
    CompensationSettings {
        control_rate: of.control_rate,
        bandwidth,
        torque_limit: of.torque_limit.min(NO_LIMIT),
        peak_torque: None,
        efficiency: of.efficiency,
        cogging_periods: of.cogging_periods_per_turn,
        torque_delay: of.delay,
        torque_lag: of.current_lag,
        motor_friction: of.motor_friction.coulomb,
        load_friction: of.load_friction.coulomb,
    }
}

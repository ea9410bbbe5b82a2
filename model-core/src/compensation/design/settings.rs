//! Settings from which a compensation is designed, and their checks.

use crate::gears::design::DesignError;
use crate::observer::design::NO_LIMIT;
use parameters::Surroundings;

/// Settings of a compensation, in addition to the joint. The half-backlash of the joint is an initial guess.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensationSettings {
    /// Control periods per second [Hz].
    pub control_rate: u32,
    /// Bandwidth of the control loop: place of its three poles [rad/s].
    pub bandwidth: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Largest torque through the teeth in position mode, at the link [N m]; `None`: the motor's torque at its limit,
    /// at most twice the rated torque.
    pub peak_torque: Option<f64>,
    /// Efficiency of the gears as far as losses grow with the torque passed on: output over input power while the motor
    /// drives [-].
    pub efficiency: f64,
    /// Periods of the motor's cogging per motor turn.
    pub cogging_periods: u32,
    /// Delay from a torque command to its first effect [control periods].
    pub torque_delay: f64,
    /// Time constant of the current loop after the delay [s].
    pub torque_lag: f64,
    /// Dry friction of the motor at the motor, as far as known [N m].
    pub motor_friction: f64,
    /// Dry friction of the link [N m].
    pub load_friction: f64,
}

/// Rejects settings from which no gains follow.
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

/// Settings of a compensation for a joint's surroundings, at a bandwidth [rad/s].
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

//! Design of the width probe: torque, waiting times and variance of the result.

use core::f64::consts::TAU;

use super::body::Body;
use super::settings::ObserverSettings;
use super::tables::design_observer;
use crate::gears::design::DesignError;
use crate::numbers::Real;
use crate::observer::tables::{ObserverTables, ProbeTable};
use parameters::JointParameters;

/// Longest duration of a probe [s].
const LONGEST: f64 = 0.5;

/// Settling time of a torque: the gap is crossed and the wind-up has stopped swinging [s].
const SETTLE: f64 = 50e-3;

/// Averaging time of a rest angle [s].
const STILL: f64 = 10e-3;

/// Time constant of the torque's rise: slow against a crossing, for soft landings [s].
const RISE: f64 = 12e-3;

/// Rate at which the damping torque removes the motor's speed: slow against any current loop [rad/s].
const DAMPING: f64 = TAU * 50.0;

/// Torque of the usual probe over the motor's limit [-]: well above friction, without hard landings.
const USUAL_SHARE: f64 = 0.2;

/// Least torque of the usual probe, over the torque uncertainty [-]: twice the least torque of any probe.
const USUAL_UNCERTAINTIES: f64 = 8.0;

/// Computes the table of the usual probe, which a controller carries; `None` if friction leaves no torque for probing.
pub fn design_usual_probe<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
) -> Result<Option<ProbeTable<T>>, DesignError> {
    let torque = (USUAL_SHARE * settings.torque_limit)
        .max(USUAL_UNCERTAINTIES * settings.torque_uncertainty)
        .min(settings.torque_limit);
    match design_probe(joint, settings, torque) {
        Ok(table) => Ok(Some(table)),
        Err(DesignError::OutOfRange { what: TORQUE, .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Name of the out-of-range quantity if no probe is possible.
const TORQUE: &str = "the torque of the width probe";

/// Computes the table of a probe that pushes with at most `torque` at the motor [N m].
pub fn design_probe<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
    torque: f64,
) -> Result<ProbeTable<T>, DesignError> {
    let tables: ObserverTables<f64> = design_observer(joint, settings)?;
    // The single torque is at least twice the expected friction.
    let least = 4.0 * settings.torque_uncertainty;
    if !(torque >= least && torque <= settings.torque_limit) {
        let must_be = "at least four times the torque uncertainty and at most the torque limit";
        return Err(DesignError::OutOfRange { what: TORQUE, given: torque, must_be });
    }
    let body = Body::new(joint);
    let real = T::from_f64;
    let step = tables.period;
    let periods = |time: f64| (time / step) as u32;
    // The gap may be three times as wide as designed.
    let widest = 3.0 * 4.0 * body.half_backlash;
    let wind_up = body.compliance * torque / body.sun_lever;
    let count = TAU / f64::from(settings.motor_encoder.counts_per_turn) * body.sun_lever;
    let friction = body.compliance * settings.torque_uncertainty / body.sun_lever;
    Ok(ProbeTable {
        torque: real(0.5 * torque),
        rise: real(-libm::expm1(-step / RISE)),
        damping: real(body.motor_inertia * DAMPING),
        moving: real((2.0 / tables.contact.per_turning).max(count / body.sun_lever / STILL)),
        loaded: real(0.5 * torque * body.ratio),
        furthest: real((widest + 4.0 * wind_up) / body.sun_lever),
        longest: periods(LONGEST),
        settle: periods(SETTLE),
        still: periods(STILL),
        per_still: real(1.0 / f64::from(periods(STILL).max(1))),
        turn: real(TAU),
        deflection: real(body.sun_lever),
        least: real(4.0 * count + friction),
        variance: real(4.0 * (friction * friction + count * count / 12.0)),
    })
}

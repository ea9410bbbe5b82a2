//! The table of the width probe: how hard it may push, how long it waits and what its figure is worth.

use core::f64::consts::TAU;

use super::body::Body;
use super::settings::ObserverSettings;
use super::tables::design_observer;
use crate::gears::design::DesignError;
use crate::numbers::Real;
use crate::observer::tables::{ObserverTables, ProbeTable};
use parameters::JointParameters;

/// A probe ends within this, one way or the other [s].
const LONGEST: f64 = 0.5;

/// Time that a torque is given to settle: the gap is crossed and the wind-up has swung [s].
const SETTLE: f64 = 50e-3;

/// Time over which an angle is taken [s].
const STILL: f64 = 10e-3;

/// Time constant with which the torque comes up: slow against a crossing, so that landings are soft [s].
const RISE: f64 = 12e-3;

/// Rate at which the damping torque takes the motor's speed out: slow against any current loop [rad/s].
const DAMPING: f64 = TAU * 50.0;

/// Part of the motor's limit that a probe uses where nothing else is said: firm beside friction, and no hard landing.
const USUAL_SHARE: f64 = 0.2;

/// Torque uncertainties that it uses at least: twice what a probe cannot do without.
const USUAL_UNCERTAINTIES: f64 = 8.0;

/// Table of the probe that a controller carries; none where friction leaves no torque to probe with.
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

/// What is out of range where a probe cannot be.
const TORQUE: &str = "the torque of the width probe";

/// Table of a probe that pushes with no more than `torque` at the motor [N m].
pub fn design_probe<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
    torque: f64,
) -> Result<ProbeTable<T>, DesignError> {
    let tables: ObserverTables<f64> = design_observer(joint, settings)?;
    // Twice the friction that is to be expected under the single torque.
    let least = 4.0 * settings.torque_uncertainty;
    if !(torque >= least && torque <= settings.torque_limit) {
        let must_be = "at least four times the torque uncertainty and at most the torque limit";
        return Err(DesignError::OutOfRange { what: TORQUE, given: torque, must_be });
    }
    let body = Body::new(joint);
    let real = T::from_f64;
    let step = tables.period;
    let periods = |time: f64| (time / step) as u32;
    // The gap may be three times as wide as it is thought to be.
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

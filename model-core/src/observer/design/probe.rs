//! Design of the width probe: torque, waiting times and variance of the result.

use core::f64::consts::TAU;

use super::body::Body;
use super::settings::ObserverSettings;
use super::tables::design_observer;
use super::thresholds::PROBE_DESIGN;
use crate::gears::design::DesignError;
use crate::numbers::Real;
use crate::observer::tables::{ObserverTables, ProbeTable};
use parameters::JointParameters;

/// Computes the table of the usual probe, which a controller carries; `None` if friction leaves no torque for probing.
pub fn design_usual_probe<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
) -> Result<Option<ProbeTable<T>>, DesignError> {
    let torque = (PROBE_DESIGN.usual_share * settings.torque_limit)
        .max(PROBE_DESIGN.usual_uncertainties * settings.torque_uncertainty)
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
    let min_torque = 4.0 * settings.torque_uncertainty;
    if !(torque >= min_torque && torque <= settings.torque_limit) {
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
        rise: real(-libm::expm1(-step / PROBE_DESIGN.rise)),
        damping: real(body.motor_inertia * PROBE_DESIGN.damping),
        moving: real((2.0 / tables.contact.per_turning).max(count / body.sun_lever / PROBE_DESIGN.average)),
        loaded: real(0.5 * torque * body.ratio),
        furthest: real((widest + 4.0 * wind_up) / body.sun_lever),
        longest: periods(PROBE_DESIGN.longest),
        settle: periods(PROBE_DESIGN.settle),
        still: periods(PROBE_DESIGN.average),
        per_still: real(1.0 / f64::from(periods(PROBE_DESIGN.average).max(1))),
        turn: real(TAU),
        deflection: real(body.sun_lever),
        least: real(4.0 * count + friction),
        variance: real(4.0 * (friction * friction + count * count / 12.0)),
    })
}

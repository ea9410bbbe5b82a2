//! What learning the motor's cogging needs: how the load side answers a torque that the motor side does not know.

use core::f64::consts::TAU;

use super::body::Body;
use super::filter::Filter;
use super::settings::ObserverSettings;
use crate::numbers::Real;
use crate::observer::tables::CoggingTable;

/// Load torques that change slower than this may be the load's own [s]: the time constant with which they are taken out, twice.
/// Chosen.
const SLOW: f64 = 20e-3;

/// Least angle by which the cogging phase goes on in that time [rad]: of slower cogging too little is left.
const LEAST: f64 = 0.6;

/// Most by which it goes on in a learning interval, and from one count of the motor to the next [rad].
const MOST: f64 = 1.0;

/// Time over which the motor shall be steady [s], and by how much of its speed it may change in it [-]: the response is that of a
/// cogging of one frequency, and what changes faster repeats from motion to motion with the cogging. Chosen.
const STEADY: (f64, f64) = (50e-3, 0.3);

/// Time on one flank after which the load torque has forgotten the landing [s]. Chosen: as long as impacts ring.
const SETTLED: f64 = 20e-3;

/// Learning intervals over which noise of the load torque, less its slow part, says the same [-]. Chosen.
const REPEATS: f64 = 5.0;

/// Largest sine or cosine that is believed, over what the joint file has [-]: beyond three standard deviations.
const LARGEST: f64 = 3.0;

/// Time over which that noise is watched [s]. Chosen.
const WATCHED: f64 = 0.1;

/// Table of the motor's cogging; a learning interval takes a while [s], and the motor side is late by another [s].
pub(super) fn table<T: Real>(
    load: &Filter,
    settings: &ObserverSettings,
    body: &Body,
    [span, late]: [f64; 2],
    step: f64,
) -> CoggingTable<T> {
    let real = T::from_f64;
    let part = |time: f64| real(-libm::expm1(-span / time));
    let periods = f64::from(settings.cogging_periods);
    // The load side in continuous time is s^3 + angle s^2 + speed s + torque.
    let angle = load.gain[0] / step;
    let speed = load.gain[1] / step;
    let torque = -load.gain[2] * load.response[(1, 0)] / (step * step);
    // A count tells where in a period the motor is.
    let told = periods * TAU / f64::from(settings.motor_encoder.counts_per_turn) <= MOST;
    let ripple = settings.torque_ripple * body.ratio;
    CoggingTable {
        periods: settings.cogging_periods,
        settled_after: libm::ceil(SETTLED / span) as u32,
        slow: part(SLOW),
        slow_time: real(SLOW * periods),
        speeds: [LEAST / SLOW, MOST / span].map(|frequency| real(frequency / periods)),
        steady: part(STEADY.0),
        unsteady: real(STEADY.1),
        response: [periods * speed / torque, periods.powi(2) * angle / torque, periods.powi(3) / torque].map(real),
        late: real(periods * late / TAU * f64::powi(2.0, 32)),
        prior: real(if told { ripple * ripple } else { 0.0 }),
        limit: real(LARGEST * ripple),
        repeats: real(REPEATS),
        memory: part(WATCHED),
    }
}

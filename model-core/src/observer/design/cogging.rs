//! Design of the cogging estimation (O17): response of the load side to a motor torque that the motor side does not
//! model.

use core::f64::consts::TAU;

use super::body::Body;
use super::filter::Filter;
use super::settings::ObserverSettings;
use crate::numbers::Real;
use crate::observer::tables::CoggingTable;

/// Time constant t_s of the high-pass filter, applied twice, that removes slow changes of the load's own torque [s].
/// Chosen.
const SLOW: f64 = 20e-3;

/// Least advance of the cogging phase within that time [rad]: the high-pass filter removes slower cogging.
const LEAST: f64 = 0.6;

/// Largest advance of the cogging phase in a learning interval, and from one motor count to the next [rad].
const MOST: f64 = 1.0;

/// Averaging time of the motor speed [s], and largest deviation from the averaged speed, over the speed [-]. The
/// response holds for a constant cogging frequency, and torques of faster speed changes repeat from motion to motion as
/// cogging does. Chosen.
const STEADY: (f64, f64) = (50e-3, 0.3);

/// Time on one flank after which the load torque has settled from the landing [s]. Chosen: as long as impacts ring.
const SETTLED: f64 = 20e-3;

/// Correlation length of the load torque's noise after the high-pass filter [learning intervals]. Chosen.
const REPEATS: f64 = 5.0;

/// Largest accepted sine or cosine amplitude, over the joint file's ripple [-]: three standard deviations.
const LARGEST: f64 = 3.0;

/// Averaging time of the noise variance [s]. Chosen.
const WATCHED: f64 = 0.1;

/// Computes the table of the motor's cogging; `span` is the length of a learning interval and `late` the lag of the
/// motor side [s].
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
    // The characteristic polynomial of the load side in continuous time is s^3 + angle s^2 + speed s + torque.
    let angle = load.gain[0] / step;
    let speed = load.gain[1] / step;
    let torque = -load.gain[2] * load.response[(1, 0)] / (step * step);
    // The cogging is estimated only if a motor count resolves its phase.
    let is_resolved = periods * TAU / f64::from(settings.motor_encoder.counts_per_turn) <= MOST;
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
        prior: real(if is_resolved { ripple * ripple } else { 0.0 }),
        limit: real(LARGEST * ripple),
        repeats: real(REPEATS),
        memory: part(WATCHED),
    }
}

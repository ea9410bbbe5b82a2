//! Design of the cogging estimation (O17): response of the load side to a motor torque that the motor side does not
//! model.

use core::f64::consts::TAU;

use super::body::Body;
use super::settings::ObserverSettings;
use super::thresholds::COGGING_DESIGN;
use crate::gears::design::kalman::Filter;
use crate::numbers::Real;
use crate::observer::tables::CoggingTable;

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
    let is_resolved = periods * TAU / f64::from(settings.motor_encoder.counts_per_turn) <= COGGING_DESIGN.max_phase;
    let ripple = settings.torque_ripple * body.ratio;
    CoggingTable {
        periods: settings.cogging_periods,
        settled_after: libm::ceil(COGGING_DESIGN.settled_time / span) as u32,
        slow: part(COGGING_DESIGN.slow_time),
        slow_time: real(COGGING_DESIGN.slow_time * periods),
        speeds: [COGGING_DESIGN.min_phase / COGGING_DESIGN.slow_time, COGGING_DESIGN.max_phase / span]
            .map(|frequency| real(frequency / periods)),
        steady: part(COGGING_DESIGN.speed_average),
        unsteady: real(COGGING_DESIGN.unsteadiness),
        response: [periods * speed / torque, periods.powi(2) * angle / torque, periods.powi(3) / torque].map(real),
        late: real(periods * late / TAU * f64::powi(2.0, 32)),
        prior: real(if is_resolved { ripple * ripple } else { 0.0 }),
        limit: real(COGGING_DESIGN.largest * ripple),
        repeats: real(COGGING_DESIGN.correlated_intervals),
        memory: part(COGGING_DESIGN.noise_average),
    }
}

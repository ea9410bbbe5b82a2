//! Design of the inertia estimation (O6): response of the load side on a stationary link, and thresholds of fast
//! torques.

use super::body::Body;
use super::settings::ObserverSettings;
use super::thresholds::{INERTIA_DESIGN, LEARNING_DESIGN};
use crate::gears::design::kalman::Filter;
use crate::numbers::Real;
use crate::observer::tables::InertiaTable;

/// Computes the table of the link's inertia; `periods` is the length of a learning interval.
pub(super) fn table<T: Real>(
    load: &Filter,
    settings: &ObserverSettings,
    body: &Body,
    periods: u32,
    step: f64,
) -> InertiaTable<T> {
    let real = T::from_f64;
    let span = f64::from(periods) * step;
    // Angle, speed and torque after an interval, from their initial values and the mesh torque.
    let after = |start: [f64; 3], given: f64| {
        (0..periods).fold(start, |[angle, speed, disturbance_torque], _| {
            let net = given - disturbance_torque;
            let ahead = [
                angle + step * speed + load.response[(0, 0)] * net,
                speed + load.response[(1, 0)] * net,
                disturbance_torque,
            ];
            let innovation = -ahead[0];
            [0, 1, 2].map(|state| ahead[state] + load.gain[state] * innovation)
        })
    };
    let columns =
        [after([1.0, 0.0, 0.0], 0.0), after([0.0, 1.0, 0.0], 0.0), after([0.0, 0.0, 1.0], 0.0), after([0.0; 3], 1.0)];
    let largest = settings.torque_limit * body.ratio;
    let noise = load.quiet[2] + (INERTIA_DESIGN.load_noise * largest).powi(2);
    InertiaTable {
        per_periods: real(1.0 / f64::from(periods)),
        still: [0, 1, 2].map(|row| columns.map(|column| real(column[row]))),
        slow: real(-libm::expm1(-span / INERTIA_DESIGN.slow_time)),
        moving: real(3.0 * libm::sqrt(load.quiet[1])),
        settled_after: libm::ceil(3.0 * INERTIA_DESIGN.slow_time / span) as u32,
        least: real(INERTIA_DESIGN.min_torque * largest),
        noise: real(INERTIA_DESIGN.correlated_intervals * noise),
        most_restless: real(INERTIA_DESIGN.external_share * noise),
        memory: real(-libm::expm1(-span / INERTIA_DESIGN.external_average)),
        prior: real(INERTIA_DESIGN.uncertainty * INERTIA_DESIGN.uncertainty),
        limit: real(3.0 * INERTIA_DESIGN.uncertainty),
        known: real(0.25 * INERTIA_DESIGN.uncertainty * INERTIA_DESIGN.uncertainty),
        drift: real(
            INERTIA_DESIGN.uncertainty * INERTIA_DESIGN.uncertainty * LEARNING_DESIGN.interval / LEARNING_DESIGN.memory,
        ),
    }
}

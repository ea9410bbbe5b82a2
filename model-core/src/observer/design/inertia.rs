//! Design of the inertia estimation (O6): response of the load side on a stationary link, and thresholds of fast
//! torques.

use super::body::Body;
use super::filter::Filter;
use super::learning::{LEARNING_INTERVAL, MEMORY};
use super::settings::ObserverSettings;
use crate::numbers::Real;
use crate::observer::tables::InertiaTable;

/// Prior standard deviation of the mobility, the designed inertia over the link's inertia [-].
const UNCERTAINTY: f64 = 0.3;

/// Time constant of the high-pass filter that removes torques of a weight [s]: longer than a swing of the teeth after a
/// landing, shorter than the link's turn through a tenth of a circle.
const SLOW: f64 = 20e-3;

/// Least fast torque for an update, over the motor's largest torque [-]: smaller torques show more noise than inertia.
const LEAST: f64 = 0.05;

/// Standard deviation of fast changes of the load torque itself, over the motor's largest torque [-].
const RESTLESS: f64 = 0.01;

/// Averaging time of the detection of external pushes [s].
const RESTLESS_FOR: f64 = 0.5;

/// Largest share of the noise variance that may remain after the high-pass filter [-]: a larger remainder means an
/// external push.
const LEFT: f64 = 0.5;

/// Correlation length of the noise [learning intervals].
const REPEATS: f64 = 10.0;

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
    let noise = load.quiet[2] + (RESTLESS * largest).powi(2);
    InertiaTable {
        per_periods: real(1.0 / f64::from(periods)),
        still: [0, 1, 2].map(|row| columns.map(|column| real(column[row]))),
        slow: real(-libm::expm1(-span / SLOW)),
        moving: real(3.0 * libm::sqrt(load.quiet[1])),
        settled_after: libm::ceil(3.0 * SLOW / span) as u32,
        least: real(LEAST * largest),
        noise: real(REPEATS * noise),
        most_restless: real(LEFT * noise),
        memory: real(-libm::expm1(-span / RESTLESS_FOR)),
        prior: real(UNCERTAINTY * UNCERTAINTY),
        limit: real(3.0 * UNCERTAINTY),
        known: real(0.25 * UNCERTAINTY * UNCERTAINTY),
        drift: real(UNCERTAINTY * UNCERTAINTY * LEARNING_INTERVAL / MEMORY),
    }
}

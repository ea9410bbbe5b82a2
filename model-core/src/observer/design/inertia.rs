//! What learning the link's inertia needs: the load side's flow on a link that stands still, and what counts as fast.

use super::body::Body;
use super::filter::Filter;
use super::learning::{LEARNING_INTERVAL, MEMORY};
use super::settings::ObserverSettings;
use crate::numbers::Real;
use crate::observer::tables::InertiaTable;

/// How far the link's inertia may be from what the joint file has, standard deviation of its inverse [-].
const UNCERTAINTY: f64 = 0.3;

/// Torques that change slower than this may be a weight's [s]: a swing of the teeth after a landing takes less, a link's
/// turn through a tenth of a circle more.
const SLOW: f64 = 20e-3;

/// Part of the motor's largest torque that a force must change by fast to show more of the link than of noise.
const LEAST: f64 = 0.05;

/// Part of the motor's largest torque by which load torques change as fast as that by themselves.
const RESTLESS: f64 = 0.01;

/// Time over which it is watched whether something pushes the link [s].
const RESTLESS_FOR: f64 = 0.5;

/// Part of such noise that is left where slow parts are taken out: where there is more, something pushes the link.
const LEFT: f64 = 0.5;

/// Intervals over which noise says the same.
const REPEATS: f64 = 10.0;

/// Table of the link's inertia, with learning intervals of so many periods.
pub(super) fn table<T: Real>(
    load: &Filter,
    settings: &ObserverSettings,
    body: &Body,
    periods: u32,
    step: f64,
) -> InertiaTable<T> {
    let real = T::from_f64;
    let span = f64::from(periods) * step;
    // Angle, speed and torque after an interval from so much of each, and of the meshes' torque.
    let after = |start: [f64; 3], given: f64| {
        (0..periods).fold(start, |[angle, speed, taken], _| {
            let net = given - taken;
            let ahead =
                [angle + step * speed + load.response[(0, 0)] * net, speed + load.response[(1, 0)] * net, taken];
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

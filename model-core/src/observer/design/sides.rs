//! Flows and gains of the motor side and the load side: how fast torques may change decides how fast the filters are.

use nalgebra::{DMatrix, DVector};

use super::body::Body;
use super::filter::{Filter, System};
use super::settings::ObserverSettings;
use crate::gears::design::exponential::flow;
use crate::numbers::Real;
use crate::observer::tables::{CurrentTable, DriveTable};

/// Time in which the load torque may change by as much as the motor can hold [s]. Friction that turns round and
/// collisions are faster, gravity slower; a filter for this follows the first with a lag of a few milliseconds.
const LOAD_CHANGE: f64 = 3.0;

/// Shortest half swing that the motor side follows [control periods].
const FASTEST_SWING: f64 = 20.0;

/// Part of the motor's largest torque by which the mesh force changes in half a swing of motor against load.
const MESH_CHANGE: f64 = 0.2;

/// Part of the motor's largest torque by which the mesh force is wrong for about a millisecond after an impact.
const IMPACT_ERROR: f64 = 0.05;

/// How long an impact's error lasts [s].
const IMPACT: f64 = 1e-3;

/// Where all three poles of the motor side are while its readings are late [rad/s]: the teeth's own swings, which nobody
/// could foresee until now, must not be carried on.
const LATE_POLES: f64 = 1000.0;

/// State: angle, speed, taken torque. The taken torque wanders so that it may change by the largest torque in half a
/// swing of motor against load; the torque noise acts on the speed.
pub(super) fn drive_filter(body: &Body, settings: &ObserverSettings, measurement_noise: f64, step: f64) -> Filter {
    let per_inertia = 1.0 / body.motor_inertia;
    // Faster swings than this are not followed: what they would cost in noise is worth more.
    let half_swing = (core::f64::consts::PI / body.contact_frequency()).max(FASTEST_SWING * step);
    let torque_noise = settings.torque_noise_ratio * settings.torque_limit;
    System {
        dynamics: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0]),
        inputs: DMatrix::zeros(3, 0),
        process_noise: DVector::from_vec(std::vec![
            0.0,
            (torque_noise * per_inertia).powi(2) * step,
            (MESH_CHANGE * settings.torque_limit).powi(2) / half_swing,
        ]),
        measurement_noise,
    }
    .filter(step)
}

/// Gains with which readings are taken in that are older than a period: all poles in one place.
fn late_gain(body: &Body, step: f64) -> [f64; 3] {
    let left = libm::exp(-LATE_POLES * step);
    let gone = 1.0 - left;
    [1.0 - left.powi(3), 1.5 * gone * gone * (1.0 + left) / step, -body.motor_inertia * gone.powi(3) / (step * step)]
}

/// By how much the taken torque lags behind one that rises steadily [s]: the innovation in the angle is then such that it
/// makes good the rise of a period, and what it adds to the speed makes good the torque that is lacking on the mean of it.
pub(super) fn drive_lag(body: &Body, filter: &Filter, step: f64) -> f64 {
    -body.motor_inertia * filter.gain[1] / filter.gain[2] - 0.5 * step
}

/// State: angle, speed, load torque.
pub(super) fn load_filter(body: &Body, settings: &ObserverSettings, measurement_noise: f64, step: f64) -> Filter {
    let per_inertia = 1.0 / body.load_inertia;
    let impact = IMPACT_ERROR * settings.torque_limit * body.ratio * per_inertia;
    System {
        dynamics: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0]),
        inputs: DMatrix::from_row_slice(3, 1, &[0.0, per_inertia, 0.0]),
        process_noise: DVector::from_vec(std::vec![0.0, impact * impact * IMPACT, load_change(body, settings),]),
        measurement_noise,
    }
    .filter(step)
}

/// Spectral density of the load torque's changes.
fn load_change(body: &Body, settings: &ObserverSettings) -> f64 {
    (settings.torque_limit * body.ratio).powi(2) / LOAD_CHANGE
}

/// Flow of the motor with its current loop: the torque in the air gap rises towards the wanted one.
pub(super) fn drive_table<T: Real>(
    body: &Body,
    settings: &ObserverSettings,
    filter: &Filter,
    step: f64,
) -> DriveTable<T> {
    let real = T::from_f64;
    let per_inertia = 1.0 / body.motor_inertia;
    let flow = if settings.torque_lag > 0.0 {
        let rate = 1.0 / settings.torque_lag;
        // Angle, speed, taken torque, air-gap torque; the wanted torque is the input.
        let dynamics = DMatrix::from_row_slice(
            4,
            4,
            &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -per_inertia, per_inertia, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -rate],
        );
        flow(&dynamics, &DMatrix::from_row_slice(4, 1, &[0.0, 0.0, 0.0, rate]), step, 1)
    } else {
        let dynamics = DMatrix::from_row_slice(
            4,
            4,
            &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        );
        flow(&dynamics, &DMatrix::from_row_slice(4, 1, &[0.0, per_inertia, 0.0, 0.0]), step, 1)
    };
    let (change, response) = (&flow.transition, &flow.input_integrals[0]);
    DriveTable {
        angle: [change[(0, 1)], change[(0, 2)], change[(0, 3)], response[0]].map(real),
        speed: [change[(1, 2)], change[(1, 3)], response[1]].map(real),
        gain: [0, 1, 2].map(|state| real(filter.gain[state])),
        late_gain: late_gain(body, step).map(real),
        variance: [real(filter.variance[0]), real(filter.variance[2])],
    }
}

/// Torque over the motor's largest beyond which a sample is none: a controller that overshoots its limit, and noise, stay
/// below it [-].
const BELIEVED: f64 = 2.0;

/// Time after a torque that was none in which the filters may still be wrong for it [s]. Chosen: several times the slowest of
/// their poles.
const UNSURE_FOR: f64 = 20e-3;

pub(super) fn current<T: Real>(settings: &ObserverSettings, step: f64) -> CurrentTable<T> {
    let whole = libm::floor(settings.torque_delay);
    let rise = if settings.torque_lag > 0.0 { -libm::expm1(-step / settings.torque_lag) } else { 1.0 };
    CurrentTable {
        whole_delay: whole as u32,
        part_delay: T::from_f64(settings.torque_delay - whole),
        rise: T::from_f64(rise),
        believed: T::from_f64(BELIEVED * settings.torque_limit),
        unsure_for: (UNSURE_FOR / step) as u16,
    }
}

#[cfg(test)]
mod tests {
    use super::{Body, drive_filter, drive_lag};
    use crate::observer::design::settings::{EncoderSettings, ObserverSettings};

    #[test]
    fn the_motor_side_lags_behind_a_steady_rise_by_as_much_as_it_says() {
        let body = Body {
            sun_lever: 7e-3,
            output_lever: 42e-3,
            ratio: 6.0,
            motor_inertia: 2.5e-4,
            load_inertia: 0.16,
            half_backlash: 40e-6,
            compliance: 1.8e-7,
            mesh_compliance: 7e-9,
            transmission_error: 6e-6,
        };
        let encoder =
            EncoderSettings { counts_per_turn: 1 << 14, wraps_at: 1 << 14, absolute: true, harmonic_error: 0.0 };
        let settings = ObserverSettings {
            control_rate: 10_000,
            clock_rate: 10_000_000,
            motor_encoder: encoder,
            output_encoder: None,
            fastest_motor: 300.0,
            torque_delay: 0.0,
            torque_lag: 0.0,
            torque_limit: 2.5,
            torque_noise_ratio: 0.015,
            torque_uncertainty: 0.05,
            torque_ripple: 0.02,
            cogging_periods: 84,
            efficiency: 1.0,
            backlash_uncertainty: 0.5,
            compliance_uncertainty: 0.3,
            skew: 0.0,
            skew_uncertainty: 0.0,
        };
        let step = 1e-4;
        let count = core::f64::consts::TAU / f64::from(encoder.counts_per_turn);
        let filter = drive_filter(&body, &settings, count * count / 12.0, step);
        let (inertia, gain) = (body.motor_inertia, &filter.gain);
        let [mut angle, mut speed, mut taken] = [0.0; 3];
        let mut time = 0.0;
        for _ in 0..2000 {
            // Nothing drives; a torque that is the time takes.
            time += step;
            angle += step * speed - 0.5 * step * step / inertia * taken;
            speed -= step / inertia * taken;
            let innovation = -time.powi(3) / (6.0 * inertia) - angle;
            angle += gain[0] * innovation;
            speed += gain[1] * innovation;
            taken += gain[2] * innovation;
        }
        let lag = time - taken;
        assert!(lag > step && (drive_lag(&body, &filter, step) / lag - 1.0).abs() < 1e-6, "it lags by {lag} s");
    }
}

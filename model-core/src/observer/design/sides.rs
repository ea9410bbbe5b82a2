//! Flows and gains of motor side (O2, O3) and load side (O4). The assumed rates of torque changes set the bandwidths.

use nalgebra::{DMatrix, DVector};

use super::body::Body;
use super::settings::ObserverSettings;
use super::thresholds::{FILTER_DESIGN, TORQUE_DESIGN};
use crate::gears::design::exponential::flow;
use crate::gears::design::kalman::{Filter, System};
use crate::numbers::Real;
use crate::observer::tables::{CurrentTable, DriveTable};

/// Motor-side filter with the states angle, speed and taken torque. The taken torque is a random walk that changes by
/// `FILTERS.mesh_change` of the largest torque in half a swing of motor against load; the torque noise acts on the
/// speed.
pub(super) fn drive_filter(body: &Body, settings: &ObserverSettings, measurement_noise: f64, step: f64) -> Filter {
    let per_inertia = 1.0 / body.motor_inertia;
    // Faster swings are not followed: the noise would cost more than the bandwidth gains.
    let half_swing = (core::f64::consts::PI / body.contact_frequency()).max(FILTER_DESIGN.shortest_half_swing * step);
    let torque_noise = settings.torque_noise_ratio * settings.torque_limit;
    System {
        dynamics: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0]),
        inputs: DMatrix::zeros(3, 0),
        process_noise: DVector::from_vec(std::vec![
            0.0,
            (torque_noise * per_inertia).powi(2) * step,
            (FILTER_DESIGN.mesh_change * settings.torque_limit).powi(2) / half_swing,
        ]),
        measurement_noise,
    }
    .filter(step)
}

/// Gains for readings older than a period (O3): all poles at `FILTERS.late_poles`.
fn late_gain(body: &Body, step: f64) -> [f64; 3] {
    let left = libm::exp(-FILTER_DESIGN.late_poles * step);
    let gone = 1.0 - left;
    [1.0 - left.powi(3), 1.5 * gone * gone * (1.0 + left) / step, -body.motor_inertia * gone.powi(3) / (step * step)]
}

/// Lag of the taken torque behind a steadily rising torque [s]. In steady state the innovation times the torque gain
/// equals the rise per period, and the innovation times the speed gain compensates the mean torque error.
pub(super) fn drive_lag(body: &Body, filter: &Filter, step: f64) -> f64 {
    -body.motor_inertia * filter.gain[1] / filter.gain[2] - 0.5 * step
}

/// Load-side filter with the states angle, speed and load torque.
pub(super) fn load_filter(body: &Body, settings: &ObserverSettings, measurement_noise: f64, step: f64) -> Filter {
    let per_inertia = 1.0 / body.load_inertia;
    let impact = FILTER_DESIGN.impact_error * settings.torque_limit * body.ratio * per_inertia;
    System {
        dynamics: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0]),
        inputs: DMatrix::from_row_slice(3, 1, &[0.0, per_inertia, 0.0]),
        process_noise: DVector::from_vec(std::vec![
            0.0,
            impact * impact * FILTER_DESIGN.impact_time,
            load_change(body, settings),
        ]),
        measurement_noise,
    }
    .filter(step)
}

/// Spectral density of the load torque's changes.
fn load_change(body: &Body, settings: &ObserverSettings) -> f64 {
    (settings.torque_limit * body.ratio).powi(2) / FILTER_DESIGN.load_change_time
}

/// Flow of the motor with its current loop: the air-gap torque approaches the wanted torque.
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
        // States: angle, speed, taken torque, air-gap torque. Input: wanted torque.
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

pub(super) fn current<T: Real>(settings: &ObserverSettings, step: f64) -> CurrentTable<T> {
    let whole = libm::floor(settings.torque_delay);
    let rise = if settings.torque_lag > 0.0 { -libm::expm1(-step / settings.torque_lag) } else { 1.0 };
    CurrentTable {
        whole_delay: whole as u32,
        part_delay: T::from_f64(settings.torque_delay - whole),
        rise: T::from_f64(rise),
        believed: T::from_f64(TORQUE_DESIGN.largest * settings.torque_limit),
        unsure_for: (TORQUE_DESIGN.uncertain_time / step) as u16,
    }
}

#[cfg(test)]
mod tests {
    use super::{Body, drive_filter, drive_lag, late_gain, load_filter};
    use crate::observer::design::settings::{EncoderSettings, ObserverSettings};

    /// Control period [s].
    const STEP: f64 = 1e-4;

    /// Joint of ratio 6 that swings against its motor with 170 Hz.
    fn body() -> Body {
        Body {
            sun_lever: 7e-3,
            output_lever: 42e-3,
            ratio: 6.0,
            motor_inertia: 2.5e-4,
            load_inertia: 0.16,
            half_backlash: 40e-6,
            compliance: 1.8e-7,
            mesh_compliance: 7e-9,
            transmission_error: 6e-6,
        }
    }

    fn settings() -> ObserverSettings {
        let encoder =
            EncoderSettings { counts_per_turn: 1 << 14, wraps_at: 1 << 14, absolute: true, harmonic_error: 0.0 };
        ObserverSettings {
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
        }
    }

    /// Variance of a rounded motor count [rad^2].
    fn rounding() -> f64 {
        let count = core::f64::consts::TAU / f64::from(settings().motor_encoder.counts_per_turn);
        count * count / 12.0
    }

    #[test]
    fn drive_lag_equals_lag_of_filter() {
        let (body, step) = (body(), STEP);
        let filter = drive_filter(&body, &settings(), rounding(), step);
        let (inertia, gain) = (body.motor_inertia, &filter.gain);
        let [mut angle, mut speed, mut disturbance_torque] = [0.0; 3];
        let mut time = 0.0;
        for _ in 0..2000 {
            // No torque drives; the taken torque equals the time.
            time += step;
            angle += step * speed - 0.5 * step * step / inertia * disturbance_torque;
            speed -= step / inertia * disturbance_torque;
            let innovation = -time.powi(3) / (6.0 * inertia) - angle;
            angle += gain[0] * innovation;
            speed += gain[1] * innovation;
            disturbance_torque += gain[2] * innovation;
        }
        let lag = time - disturbance_torque;
        assert!(lag > step && (drive_lag(&body, &filter, step) / lag - 1.0).abs() < 1e-6, "it lags by {lag} s");
    }

    #[test]
    fn half_swings_below_20_periods_are_one() {
        // Gain of the taken torque of a joint with a half swing of this many periods.
        let gain = |periods: f64| {
            let body = body();
            let compliance =
                body.compliance * (periods * STEP * body.contact_frequency() / core::f64::consts::PI).powi(2);
            drive_filter(&Body { compliance, ..body }, &settings(), rounding(), STEP).gain[2]
        };
        assert!(gain(19.0) == gain(11.0) && gain(21.0) > gain(19.0), "{} {}", gain(21.0), gain(19.0));
    }

    #[test]
    fn drive_side_lags_by_600_us() {
        // The mesh torque may change by a fifth of the motor's limit in half a swing of 2.9 ms.
        let lag = drive_lag(&body(), &drive_filter(&body(), &settings(), rounding(), STEP), STEP);
        assert!((lag - 0.58e-3).abs() < 0.02e-3, "{lag}");
    }

    #[test]
    fn impact_sets_the_gain_of_the_link_speed() {
        // An impact leaves an error of 5 % of the motor's limit for 1 ms; the load changes by the limit in 3 s.
        let filter = load_filter(&body(), &settings(), rounding(), STEP);
        assert!((filter.gain[1] - 29.6).abs() < 0.5, "{} 1/s", filter.gain[1]);
    }

    #[test]
    fn late_readings_decay_with_1000_per_second() {
        let (gain, inertia) = (late_gain(&body(), STEP), body().motor_inertia);
        // The trace of the filter's matrix is the sum of its three poles.
        let trace = 3.0 - gain[0] - STEP * gain[1] + 0.5 * STEP * STEP / inertia * gain[2];
        assert!((trace - 3.0 * libm::exp(-0.1)).abs() < 1e-9, "{trace}");
    }
}

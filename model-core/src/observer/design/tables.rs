//! Tables of the observer, computed from joint, encoders and prior uncertainties.
//!
//! No gain is set by hand. Both filters are steady-state Kalman filters for the encoders' quantisation (O5) and the
//! rates of torque changes; the parameter estimation starts from the stated uncertainties; thresholds are multiples of
//! the resulting noise, or the times and fractions of `thresholds`.

use core::f64::consts::TAU;

use super::body::Body;
use super::settings::{EncoderSettings, ObserverSettings};
use super::sides::{current, drive_filter, drive_lag, drive_table, load_filter};
use super::thresholds::{
    BIAS_DESIGN, CLOCK_DESIGN, CONTACT_DESIGN, LEARNING_DESIGN, RESPONSE_DESIGN, ROUNDING_DESIGN, SUPERVISION_DESIGN,
};
use super::{cogging, inertia};
use crate::gears::Kinematics;
use crate::gears::design::kalman::Filter;
use crate::gears::design::{DesignError, validate};
use crate::numbers::count_weights::CountWeights;
use crate::numbers::{Real, digest};
use crate::observer::tables::{
    ClockTable, ContactTable, CountTable, EncoderTable, LearnerTable, LeverTable, LoadTable, MOST_PARAMETERS,
    ObserverTables, ResponseTable, StopTable, SupervisorTable,
};
use parameters::JointParameters;

/// Slope of a once- and a twice-per-turn error of equal size together, over that size: sqrt(1 + 2^2).
const HARMONIC_SLOPE: f64 = 2.2;

/// Computes the tables of the observer.
pub fn design_observer<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
) -> Result<ObserverTables<T>, DesignError> {
    validate(joint)?;
    let body = Body::new(joint);
    settings.check(body.gap_at_motor())?;
    let step = 1.0 / f64::from(settings.control_rate);
    let counts = counts::<T>(joint, settings, step)?;
    let design = Design::new(joint, settings, body, step);
    let Design { body, drive, load, periods, .. } = &design;
    let prior = design.prior();
    let numbers = prior.mean.iter().chain(&prior.deviation);
    Ok(ObserverTables {
        identity: numbers.fold(identity(joint, settings), |running, number| digest::chain(running, number.to_bits())),
        control_rate: settings.control_rate,
        period: T::from_f64(step),
        clock: clock(step, settings.clock_rate),
        counts,
        levers: levers(body),
        current: current(settings, step),
        drive: drive_table(body, settings, drive, step),
        load: design.load_table(),
        inertia: inertia::table(load, settings, body, *periods as u32, step),
        cogging: cogging::table(load, settings, body, [periods * step, drive_lag(body, drive, step)], step),
        contact: design.contact_table(),
        learner: design.learner_table(&prior),
        supervisor: design.supervisor_table(),
        response: response(body, settings, design.motor_count, step),
    })
}

/// Filters of a joint, and the noise that they leave.
struct Design<'a> {
    joint: &'a JointParameters,
    settings: &'a ObserverSettings,
    body: Body,
    /// Control period [s].
    step: f64,
    /// Angles of a count of motor and output [rad].
    motor_count: f64,
    output_count: f64,
    drive: Filter,
    load: Filter,
    /// Control periods of a learning interval, and learning intervals of a batch.
    periods: f64,
    batch: f64,
    /// Torque ripple as mesh force [N].
    ripple: f64,
    /// Noise variances of mesh force [N^2], deflection, and mean deflection by the force's wind-up [m^2].
    force_variance: f64,
    deflection_variance: f64,
    wind_up_variance: f64,
    /// Deviations of the harmonics of the encoders' errors [m].
    motor_harmonic: f64,
    output_harmonic: f64,
}

/// Prior of the estimated parameters.
struct Prior {
    mean: [f64; MOST_PARAMETERS],
    deviation: [f64; MOST_PARAMETERS],
}

impl<'a> Design<'a> {
    fn new(joint: &'a JointParameters, settings: &'a ObserverSettings, body: Body, step: f64) -> Self {
        let motor_count = TAU / f64::from(settings.motor_encoder.counts_per_turn);
        let output_count = TAU / f64::from(settings.output_encoder.unwrap_or(settings.motor_encoder).counts_per_turn);
        let motor_speed = body.ratio * ROUNDING_DESIGN.motor_speed;
        let drive = drive_filter(&body, settings, rounding(motor_count, motor_speed, step), step);
        let load = load_filter(&body, settings, rounding(output_count, ROUNDING_DESIGN.link_speed, step), step);
        let force_variance = drive.quiet[2] / (body.sun_lever * body.sun_lever);
        let periods = libm::round(LEARNING_DESIGN.interval / step).max(1.0);
        let ripple = settings.torque_ripple / body.sun_lever;
        let harmonics = |encoder: Option<EncoderSettings>, lever: f64| {
            encoder.map_or(0.0, |encoder| encoder.harmonic_error) * lever / core::f64::consts::SQRT_2
        };
        Self {
            joint,
            settings,
            step,
            motor_count,
            output_count,
            periods,
            batch: libm::round(LEARNING_DESIGN.batch / LEARNING_DESIGN.interval).max(1.0),
            ripple,
            force_variance,
            deflection_variance: drive.quiet[0] * body.sun_lever.powi(2) + load.quiet[0] * body.output_lever.powi(2),
            wind_up_variance: body.compliance.powi(2) * (force_variance / periods + ripple * ripple),
            motor_harmonic: harmonics(Some(settings.motor_encoder), body.sun_lever),
            output_harmonic: harmonics(settings.output_encoder, body.output_lever),
            body,
            drive,
            load,
        }
    }

    /// Largest mesh force of the motor [N].
    fn largest_force(&self) -> f64 {
        self.settings.torque_limit / self.body.sun_lever
    }

    /// Half-gap as designed [m].
    fn half_gap(&self) -> f64 {
        2.0 * self.body.half_backlash
    }

    fn prior(&self) -> Prior {
        let Self { settings, body, .. } = self;
        let mut deviation = [0.0; MOST_PARAMETERS];
        deviation[0] = self.half_gap() * settings.backlash_uncertainty;
        deviation[1] = 2.0 * self.half_gap() + body.compliance * self.largest_force();
        deviation[2] = body.compliance * settings.compliance_uncertainty;
        deviation[3] = body.output_lever * settings.skew_uncertainty;
        deviation[4..6].fill(body.transmission_error / core::f64::consts::SQRT_2);
        deviation[6..10].fill(self.motor_harmonic);
        deviation[10..14].fill(self.output_harmonic);
        let mut mean = [0.0; MOST_PARAMETERS];
        mean[0] = self.half_gap();
        mean[2] = body.compliance;
        mean[3] = body.output_lever * settings.skew;
        Prior { mean, deviation }
    }

    fn load_table<T: Real>(&self) -> LoadTable<T> {
        let Self { body, load, force_variance, ripple, .. } = self;
        let real = T::from_f64;
        // Without an output encoder, the wind-up of the mesh force measures the link.
        let measurement_noise = (self.deflection_variance
            + body.compliance.powi(2) * (force_variance + ripple * ripple))
            / body.output_lever.powi(2);
        let motor_only = load_filter(body, self.settings, measurement_noise, self.step);
        LoadTable {
            angle: [real(self.step), real(load.response[(0, 0)])],
            speed: real(load.response[(1, 0)]),
            gain: [0, 1, 2].map(|state| real(load.gain[state])),
            variance: [real(load.variance[0]), real(load.variance[2])],
            motor_only_gain: [0, 1, 2].map(|state| real(motor_only.gain[state])),
            motor_only_variance: [real(motor_only.variance[1]), real(motor_only.variance[2])],
            deflection_per_torque: real(0.5 * body.output_lever / body.load_inertia),
        }
    }

    fn contact_table<T: Real>(&self) -> ContactTable<T> {
        let Self { settings, body, drive, load, step, force_variance, deflection_variance, ripple, .. } = self;
        let real = T::from_f64;
        let sigma = CONTACT_DESIGN.noise_sigma;
        let bias_prior = (settings.torque_uncertainty / body.sun_lever).powi(2);
        let meshes = f64::from(self.joint.geometry.ring_teeth);
        ContactTable {
            force_variance: real(*force_variance),
            ripple_variance: real(ripple * ripple),
            deflection_variance: real(*deflection_variance),
            bias_noise: real((force_variance + ripple * ripple) * BIAS_DESIGN.correlated_intervals),
            bias_prior: real(bias_prior),
            bias_drift: real(bias_prior * LEARNING_DESIGN.interval / BIAS_DESIGN.drift_time),
            bias_limit: real(sigma * settings.torque_uncertainty / body.sun_lever),
            still: real(
                sigma * libm::sqrt(2.0 * (deflection_variance + self.wind_up_variance)) / LEARNING_DESIGN.window,
            ),
            still_per_speed: real(
                2.0 * (HARMONIC_SLOPE * self.motor_harmonic
                    + (self.output_harmonic + meshes * body.transmission_error) / body.ratio),
            ),
            per_turning: real(1.0 / (sigma * libm::sqrt(drive.quiet[1]))),
            rate_deviation: real(libm::sqrt(
                drive.quiet[1] * body.sun_lever.powi(2) + load.quiet[1] * body.output_lever.powi(2),
            )),
            lag: real(CONTACT_DESIGN.landing_lag * step),
            smoothing: real(-libm::expm1(-step / (CONTACT_DESIGN.smoothing_intervals * LEARNING_DESIGN.interval))),
            known_part: real(CONTACT_DESIGN.known_half_gap),
            loss_driving: real(settings.efficiency - 1.0),
            loss_driven: real(1.0 / settings.efficiency - 1.0),
        }
    }

    fn learner_table<T: Real>(&self, prior: &Prior) -> LearnerTable<T> {
        let Self { settings, body, step, periods, batch, ripple, .. } = self;
        let real = T::from_f64;
        let unmodelled = CONTACT_DESIGN.unmodelled_errors * settings.motor_encoder.harmonic_error * body.sun_lever;
        let noise = libm::sqrt(self.deflection_variance + self.wind_up_variance + unmodelled * unmodelled);
        LearnerTable {
            periods: *periods as u16,
            per_periods: real(1.0 / periods),
            middle: *periods as u16 / 2 + 1,
            block: *batch as u32,
            per_block: real(1.0 / batch),
            span: real(periods * step),
            mean: prior.mean.map(real),
            deviation: prior.deviation.map(real),
            weight: real(1.0 / noise),
            noise: real(noise),
            force_noise: real(self.force_variance / (periods * batch) + 0.5 * ripple * ripple),
            force_lag: real(drive_lag(body, &self.drive, *step) / (periods * step)),
            forgetting: real(LEARNING_DESIGN.interval / LEARNING_DESIGN.memory),
            mesh_compliance: real(body.mesh_compliance),
        }
    }

    fn supervisor_table<T: Real>(&self) -> SupervisorTable<T> {
        let Self { settings, body, step, motor_count, output_count, .. } = self;
        let real = T::from_f64;
        let limits = SUPERVISION_DESIGN;
        let stop = |time: f64| libm::round(time / step).clamp(1.0, 250.0);
        let stops = |stop: f64, forgotten: f64| StopTable {
            stop: stop as u8,
            forgotten: forgotten as u8,
            per_stops: real(0.5 / stop),
        };
        let brake = |torque: f64, inertia: f64, count: f64| 0.5 * torque / inertia * step * step / count;
        let link_brake = limits.link_brake * settings.torque_limit * body.ratio;
        // Teeth stop the motor like a spring, in at least a quarter of a swing.
        let motor_stop = libm::floor(0.25 * TAU / body.contact_frequency() / step).clamp(1.0, 250.0);
        SupervisorTable {
            silent_after: (limits.output_silence / step) as u16,
            failed_after: (limits.output_fault_time / step) as u16,
            output: stops(stop(limits.link_stop_time), stop(limits.link_stop_time)),
            motor: stops(motor_stop, stop(limits.motor_speed_kept)),
            output_brake: real(brake(link_brake, body.load_inertia, *output_count)),
            motor_brake: real(brake(1.0, body.motor_inertia, *motor_count)),
            motor_drag: real(CONTACT_DESIGN.noise_sigma * settings.torque_uncertainty),
            motor_counts: real(body.ratio * output_count / motor_count),
            motor_unmoved_after: (limits.motor_standstill / step) as u16,
            motor_trusted_after: (limits.motor_readmission / step) as u16,
            motor_slipped_after: (limits.motor_slip_readmission / step) as u16,
            trusted_after: (limits.output_readmission / LEARNING_DESIGN.interval) as u16,
            moved: libm::ldexp(limits.min_motion * output_count / TAU, 32) as u32,
            margin: real(
                limits.deflection_margin * self.half_gap()
                    + limits.deflection_margin * body.compliance * self.largest_force(),
            ),
            widest_part: real(limits.widest_gap),
        }
    }
}

fn levers<T: Real>(body: &Body) -> LeverTable<T> {
    let real = T::from_f64;
    LeverTable {
        sun: real(body.sun_lever),
        per_sun: real(1.0 / body.sun_lever),
        output: real(body.output_lever),
        per_output: real(1.0 / body.output_lever),
        ratio: real(body.ratio),
        per_ratio: real(1.0 / body.ratio),
    }
}

/// Variance R of a reading's rounding (O5), for a count [rad] and a shaft speed [rad/s]: grows with the periods per
/// count [rad^2].
fn rounding(count: f64, speed: f64, step: f64) -> f64 {
    count * count / 12.0 * (count / (speed * step)).max(1.0)
}

/// Computes the table of the sign check (O25).
fn response<T: Real>(body: &Body, settings: &ObserverSettings, motor_count: f64, step: f64) -> ResponseTable<T> {
    let inertia = body.motor_inertia + body.load_inertia / (body.ratio * body.ratio);
    let unsure = (RESPONSE_DESIGN.block_counts * motor_count).max(RESPONSE_DESIGN.block_gaps * body.gap_at_motor());
    let length = libm::sqrt(unsure * inertia / settings.torque_limit)
        .max(RESPONSE_DESIGN.block_swings * TAU / body.contact_frequency());
    let block = libm::round(length.clamp(RESPONSE_DESIGN.block_time[0], RESPONSE_DESIGN.block_time[1]) / step)
        .max(RESPONSE_DESIGN.block_periods);
    let length = block * step;
    ResponseTable {
        block: block as u16,
        per_block: T::from_f64(1.0 / block),
        inertia: T::from_f64(inertia / (length * length)),
        large: T::from_f64(RESPONSE_DESIGN.large_torque * settings.torque_limit),
        alone: T::from_f64(2.0 * inertia / body.motor_inertia),
    }
}

fn counts<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
    step: f64,
) -> Result<CountTable<T>, DesignError> {
    let motor = settings.motor_encoder;
    let output = settings.output_encoder.unwrap_or(motor);
    let geometry = &joint.geometry;
    let weights = CountWeights::new(
        motor.counts_per_turn,
        output.counts_per_turn,
        geometry.sun_teeth + geometry.ring_teeth,
        geometry.sun_teeth,
    )
    .ok_or(DesignError::OutOfRange {
        what: "the whole numbers of ratio and counts in a turn",
        given: geometry.ratio_by_teeth(),
        must_be: "of fewer digits, or share divisors: motor and output could not be compared in 64 bits",
    })?;
    let encoder = |encoder: EncoderSettings, fastest: f64| EncoderTable {
        turn: encoder.counts_per_turn,
        wraps_at: encoder.wraps_at,
        last: encoder.wraps_at.wrapping_sub(1),
        phase: (libm::ldexp(1.0, 64) / f64::from(encoder.counts_per_turn)) as u64,
        // Twice the largest speed, limited to half a turn, beyond which the direction is ambiguous.
        fastest: (libm::ceil(2.0 * fastest * step / TAU * f64::from(encoder.counts_per_turn)) as u32 + 2)
            .min(encoder.counts_per_turn / 2),
        angle: T::from_f64(TAU / f64::from(encoder.counts_per_turn)),
        fraction: T::from_f64(1.0 / f64::from(encoder.counts_per_turn)),
        turns: T::from_f64(1.0 / TAU),
    };
    let unit = TAU / f64::from(motor.counts_per_turn) / weights.motor as f64;
    Ok(CountTable {
        motor: encoder(motor, settings.fastest_motor),
        output: encoder(output, settings.fastest_motor / geometry.ratio_by_teeth()),
        absolute: motor.absolute && output.absolute,
        has_output: settings.output_encoder.is_some(),
        motor_weight: weights.motor,
        output_weight: weights.output,
        modulus: weights.modulus,
        meshes: geometry.ring_teeth,
        mesh_periods: T::from_f64(geometry.ring_teeth.into()),
        length: T::from_f64(unit * geometry.sun_base_radius),
    })
}

/// Computes the table of the samples' clock; `period` is the control period [s].
fn clock<T: Real>(period: f64, rate: u32) -> ClockTable<T> {
    let ticks = |periods: f64| libm::round(periods * period * f64::from(rate)) as u32;
    let [shortest, longest] = CLOCK_DESIGN.accepted_periods.map(ticks);
    ClockTable {
        tick: T::from_f64(1.0 / f64::from(rate)),
        period: ticks(1.0),
        shortest,
        longer: longest - shortest,
        oldest: ticks(CLOCK_DESIGN.oldest_reading),
    }
}

/// Digest of joint and encoders to which a saved memory belongs.
fn identity(joint: &JointParameters, settings: &ObserverSettings) -> u64 {
    let geometry = &joint.geometry;
    let output = settings.output_encoder.map_or(0, |encoder| encoder.counts_per_turn);
    let words = [
        geometry.sun_teeth,
        geometry.planet_teeth,
        geometry.ring_teeth,
        settings.motor_encoder.counts_per_turn,
        output,
    ];
    let named = joint.name.bytes().fold(digest::START, |running, byte| digest::chain(running, byte.into()));
    let counted = words.into_iter().fold(named, |running, word| digest::chain(running, word.into()));
    digest::chain(counted, geometry.sun_base_radius.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::design::observer_settings;

    /// Surroundings of Q1, with a motor of 1 N m.
    fn settings() -> ObserverSettings {
        let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        ObserverSettings { torque_limit: 1.0, ..observer_settings(&q1.surroundings) }
    }

    /// Joint without a gap and with levers of 1 m, whose motor of 1 g m^2 turns a link of 1 kg m^2.
    fn body() -> Body {
        Body {
            sun_lever: 1.0,
            output_lever: 1.0,
            ratio: 1000.0,
            motor_inertia: 1e-3,
            load_inertia: 1.0,
            half_backlash: 0.0,
            compliance: 1e-9,
            mesh_compliance: 1e-9,
            transmission_error: 0.0,
        }
    }

    /// Length of a block in periods of 0.1 ms, for the angle of a motor count [rad].
    fn block(body: &Body, motor_count: f64) -> u16 {
        response::<f64>(body, &settings(), motor_count, 1e-4).block
    }

    #[test]
    fn block_moves_the_motor_by_24_counts() {
        // 1 N m turns 1.001 g m^2 by 0.24 rad, from block to block of 15.5 ms.
        assert_eq!(block(&body(), 0.01), 155);
    }

    #[test]
    fn block_moves_the_motor_by_four_gaps() {
        assert_eq!(block(&Body { half_backlash: 0.015, ..body() }, 0.0), 155);
    }

    #[test]
    fn block_lasts_half_a_swing() {
        // 1 g m^2 swing with a period of 20 ms.
        let compliance = 1.0 / (1e-3 * (TAU / 20e-3_f64).powi(2));
        assert_eq!(block(&Body { compliance, ..body() }, 0.0), 100);
    }

    #[test]
    fn block_lasts_from_2_to_30_ms() {
        assert_eq!([0.0, 1.0].map(|count| block(&body(), count)), [20, 300]);
    }

    #[test]
    fn block_lasts_eight_periods() {
        // 2 ms have two periods at 1 kHz.
        assert_eq!(response::<f64>(&body(), &settings(), 0.0, 1e-3).block, 8);
    }
}

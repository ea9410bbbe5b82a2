//! Conversion of the observer's state to published estimates: values in the user's units, variances (O18, O19, O20) and
//! validity flags.

use super::contact::Contact;
use super::filters::Filters;
use super::health::Health;
use super::identification::ParameterEstimator;
use super::identification::mesh_measurement::MeshMeasurement;
use super::identification::regressors::{MAPPED, OFFSET, SKEW};
use super::identification::uncertainty::Uncertainty;
use super::sensors::Sensors;
use super::sensors::counts::Counter;
use super::tables::{EncoderTable, ObserverTables};
use super::thresholds::ValidityThresholds;
use crate::estimates::{Estimate, Estimates, MotorFault, Shaft, Source};
use crate::gears::contact_state;
use crate::numbers::Real;

/// Parts of the observer from which the estimates of a period are computed.
#[derive(Clone, Copy)]
pub(super) struct ObserverParts<'now, T: Real, const P: usize> {
    pub tables: &'now ObserverTables<T>,
    pub sensors: &'now Sensors,
    pub filters: &'now Filters<T>,
    pub contact: &'now Contact,
    pub estimator: &'now ParameterEstimator<T, P>,
    pub health: &'now Health<T>,
}

impl<T: Real, const P: usize> ObserverParts<'_, T, P> {
    /// Publishes the estimates of a period.
    #[inline]
    pub fn publish(&self, measurement: &MeshMeasurement<T>, estimates: &mut Estimates<T>) {
        let tables = self.tables;
        let both_encoders = self.health.both_encoders();
        let is_touching = self.contact.reported.is_some();
        let gap = self.gap(measurement, both_encoders, is_touching);
        let (motor, link) = self.shafts(both_encoders);
        let [sine, cosine] = self.estimator.errors.mesh;
        let slope = self.estimator.transmission_error(&[cosine, -sine]) * tables.counts.mesh_periods;

        estimates.source = self.health.source();
        estimates.gap = gap;
        estimates.gap_rate = if is_touching { T::ZERO } else { measurement.rate };
        estimates.flank_shift = measurement.flank_shift;
        estimates.flank_shift_slope = slope;
        estimates.contact = contact_state(self.contact.by_force.flank);
        estimates.reported_contact = contact_state(self.contact.reported);
        // A reported flank needs no valid gap coordinate: without a half-gap or an output encoder, force alone decides.
        // Flanks that the transmission error shifts over the middle of the gap hammer at every tooth: each contact ends
        // before a controller could react.
        estimates.contact_valid = (is_touching || gap.valid) && !self.estimator.uncertainty.flanks_swap;
        estimates.mesh_torque.valid = estimates.contact_valid;
        estimates.load_torque.value = self.filters.load.torque * estimates.link_inertia_ratio.value;
        estimates.load_torque.valid = both_encoders || is_touching;
        estimates.motor_lead =
            (measurement.deflection + self.estimator.least_squares.value(OFFSET)) * tables.levers.per_output;
        estimates.motor = motor;
        estimates.link = link;
    }

    /// Computes the gap coordinate (O8) with its variance (O18, O19).
    #[inline]
    fn gap(&self, measurement: &MeshMeasurement<T>, both_encoders: bool, is_touching: bool) -> Estimate<T> {
        let tables = self.tables;
        let uncertainty = &self.estimator.uncertainty;
        let (value, variance) = if !both_encoders {
            self.gap_without_output(measurement, is_touching)
        } else if uncertainty.half_gap_is_usable {
            let [touches, open] = uncertainty.gap_variance;
            // The estimate must last until the next period, during which teeth in the open gap move on.
            let travel = measurement.rate * tables.period;
            let variance = if is_touching { touches } else { open + travel * travel };
            (
                measurement.flank_shift
                    + self
                        .estimator
                        .gap_position(measurement.tooth_deflection(), T::ZERO)
                        .gap_coordinate(uncertainty.mesh_share),
                variance,
            )
        } else {
            // Without a half-gap the wind-up of the force is subtracted.
            let [_, compliance] = self.estimator.half_gap_and_compliance();
            let wind_up = compliance - tables.learner.mesh_compliance;
            let of_wind_up = wind_up * uncertainty.force_deviation;
            let force = if is_touching { measurement.force } else { T::ZERO };
            let noise = tables.contact.deflection_variance;
            (
                measurement.deflection - wind_up * force,
                uncertainty.deflection_variance + noise + of_wind_up * of_wind_up,
            )
        };
        let valid = variance < uncertainty.widest_variance && !self.health.is_deflection_out_of_range(tables);
        Estimate { value, variance, valid }
    }

    /// Computes gap coordinate and variance (O26) without an output encoder.
    #[cold]
    fn gap_without_output(&self, measurement: &MeshMeasurement<T>, is_touching: bool) -> (T, T) {
        let [half_gap, _] = self.estimator.half_gap_and_compliance();
        let (upper, lower) = (measurement.flank_shift + half_gap, measurement.flank_shift - half_gap);
        let value = if let Some(certain) = self.health.unseen_link.certain {
            let force = if is_touching { measurement.force } else { T::ZERO };
            measurement.flank_shift + certain.sign::<T>() * half_gap + self.tables.learner.mesh_compliance * force
        } else if measurement.deflection > upper {
            upper
        } else if measurement.deflection < lower {
            lower
        } else {
            measurement.deflection
        };
        let variance = self.health.unseen_link.gap_variance(self.tables, self.estimator);
        (value, variance.unwrap_or(half_gap * half_gap))
    }

    /// Computes both shafts, without the estimated encoder errors.
    #[inline]
    fn shafts(&self, both_encoders: bool) -> (Shaft<T>, Shaft<T>) {
        let (tables, counts) = (self.tables, &self.sensors.counts);
        let (drive, load) = (&self.filters.drive, &self.filters.load);
        let levers = &tables.levers;
        let (output, _) = counts.output_in_use();
        let skew_residual = if both_encoders { load.speed * self.estimator.least_squares.value(SKEW) } else { T::ZERO };
        let (motor_error, output_error) = if P == MAPPED {
            let [of_motor, of_output] = self.estimator.errors.errors;
            (of_motor * levers.per_sun, (skew_residual + of_output) * levers.per_output)
        } else {
            (T::ZERO, skew_residual * levers.per_output)
        };
        let motor = shaft(&tables.counts.motor, &counts.motor, drive.angle_residual - motor_error, drive.speed);
        let link = shaft(&tables.counts.output, output, load.angle_residual + output_error, load.speed);
        (motor, link)
    }
}

/// Holds the estimates and marks them invalid, without a usable motor reading.
#[cold]
pub(super) fn hold<T: Real>(estimates: &mut Estimates<T>, fault: MotorFault) {
    estimates.source = Source::Nothing(fault);
    invalidate(estimates);
}

/// Keeps the values and marks gap, contact and torques invalid.
#[cold]
pub(super) fn invalidate<T: Real>(estimates: &mut Estimates<T>) {
    estimates.contact_valid = false;
    estimates.settled = false;
    for estimate in [&mut estimates.gap, &mut estimates.mesh_torque, &mut estimates.load_torque] {
        estimate.valid = false;
    }
}

/// Publishes the parameters that change once per learning interval.
pub(super) fn publish_parameters<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    estimator: &ParameterEstimator<T, P>,
    both_encoders: bool,
    estimates: &mut Estimates<T>,
) {
    publish_torque_variances(tables, &estimator.uncertainty, both_encoders, estimates);
    publish_tooth_parameters(tables, estimator, both_encoders, estimates);
    let sun_squared = tables.levers.sun * tables.levers.sun;
    let max_bias_variance = ValidityThresholds::<T>::TUNED.bias * tables.contact.bias_prior;
    let motor_estimate = |force: T, variance: T| Estimate {
        value: force * tables.levers.sun,
        variance: variance * sun_squared,
        valid: variance < max_bias_variance,
    };
    let [bias_variance, friction_variance, _] = estimator.bias.variance;
    estimates.torque_bias = motor_estimate(estimator.bias.bias, bias_variance);
    estimates.motor_friction = motor_estimate(estimator.bias.friction, friction_variance);
    let [value, variance] = estimator.inertia.ratio();
    estimates.link_inertia_ratio = Estimate { value, variance, valid: variance < tables.inertia.known * value * value };
}

/// Publishes the variances of mesh and load torque, and settled contact.
fn publish_torque_variances<T: Real>(
    tables: &ObserverTables<T>,
    uncertainty: &Uncertainty<T>,
    both_encoders: bool,
    estimates: &mut Estimates<T>,
) {
    let force_deviation = if both_encoders && uncertainty.half_gap_is_usable {
        uncertainty.combined_deviation
    } else {
        uncertainty.force_deviation
    };
    let mesh_deviation = force_deviation * tables.levers.output;
    let [_, load_variance] = tables.load.variance;
    estimates.settled = uncertainty.settled;
    estimates.mesh_torque.variance = mesh_deviation * mesh_deviation;
    estimates.load_torque.variance = load_variance;
}

/// Publishes half-backlash, offset, compliance and skew.
fn publish_tooth_parameters<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    estimator: &ParameterEstimator<T, P>,
    both_encoders: bool,
    estimates: &mut Estimates<T>,
) {
    let limits = ValidityThresholds::<T>::TUNED;
    let levers = &tables.levers;
    let [half_gap, compliance] = estimator.half_gap_and_compliance();
    let (offset, skew) = (estimator.least_squares.value(OFFSET), estimator.least_squares.value(SKEW));
    let [half_gap_variance, offset_variance, compliance_variance, skew_variance] = estimator.uncertainty.variances;
    let [_, of_flank] = estimator.uncertainty.wind_up_variance;
    let half_gap_variance = half_gap_variance + of_flank;
    let local_variance = half_gap_variance + estimator.half_gap_variation_variance(tables);
    let max_deviation = limits.half_gap * half_gap;
    let output_squared = levers.per_output * levers.per_output;
    estimates.half_backlash_usable = half_gap > T::ZERO && half_gap_variance < max_deviation * max_deviation;
    estimates.half_backlash = Estimate {
        value: half_gap * T::HALF,
        variance: local_variance * T::HALF * T::HALF,
        valid: half_gap > T::ZERO && local_variance < max_deviation * max_deviation,
    };
    estimates.encoder_offset = Estimate {
        value: offset * levers.per_output,
        variance: offset_variance * output_squared,
        valid: both_encoders && offset_variance < max_deviation * max_deviation,
    };
    estimates.compliance = Estimate {
        value: compliance * output_squared,
        variance: compliance_variance * output_squared * output_squared,
        valid: compliance_variance < limits.compliance * compliance * compliance,
    };
    estimates.skew =
        Estimate { value: skew * levers.per_output, variance: skew_variance * output_squared, valid: both_encoders };
}

/// Builds a shaft from its counts and the angle beyond the counts [rad].
fn shaft<T: Real>(table: &EncoderTable<T>, counter: &Counter, residual: T, speed: T) -> Shaft<T> {
    let fraction = T::from_i32(counter.place() as i32) * table.fraction + residual * table.turns;
    // One comparison checks both ends of the turn: a floating-point comparison costs three instructions.
    let within = (fraction - T::HALF).abs() < T::HALF;
    let (turns, fraction) = if within { (counter.turns(), fraction) } else { into_turn(counter.turns(), fraction) };
    Shaft { turns, fraction, speed }
}

/// Normalises a position that lies in the previous or the next turn.
#[cold]
fn into_turn<T: Real>(turns: i32, fraction: T) -> (i32, T) {
    if fraction < T::ZERO {
        (turns.wrapping_sub(1), fraction + T::ONE)
    } else if fraction >= T::ONE {
        (turns.wrapping_add(1), fraction - T::ONE)
    } else {
        (turns, fraction)
    }
}

#[cfg(test)]
mod tests {
    use super::super::identification::regressors::{COMPLIANCE, PLAIN};
    use super::*;
    use crate::observer::test_tables::{estimator, observer};

    /// Estimates of a joint with a half-gap of 80 um and a compliance of 1 um/N, after a change of their variances.
    fn published(change: impl FnOnce(&mut ParameterEstimator<f32, PLAIN>)) -> Estimates<f32> {
        let (tables, mut estimates) = (observer(), Estimates::default());
        let mut estimator = estimator(&tables);
        estimator.least_squares.values[COMPLIANCE] = 1e-6;
        change(&mut estimator);
        publish_parameters(&tables, &estimator, true, &mut estimates);
        estimates
    }

    #[test]
    fn half_gap_known_to_an_eighth_is_valid() {
        let is_valid = |deviation: f32| {
            let estimates = published(|estimator| estimator.uncertainty.variances = [deviation * deviation; 4]);
            assert_eq!(estimates.half_backlash.valid, estimates.encoder_offset.valid);
            estimates.half_backlash.valid
        };
        assert!(is_valid(9.9e-6) && !is_valid(10.1e-6));
    }

    #[test]
    fn compliance_known_to_22_percent_is_valid() {
        let is_valid = |deviation: f32| {
            published(|estimator| estimator.uncertainty.variances[2] = deviation * deviation).compliance.valid
        };
        assert!(is_valid(0.22e-6) && !is_valid(0.23e-6));
    }

    #[test]
    fn bias_with_half_its_variance_is_valid() {
        // Prior variance of 4 N^2.
        let is_valid = |variance: f32| {
            let estimates = published(|estimator| estimator.bias.variance = [variance, variance, 0.0]);
            [estimates.torque_bias.valid, estimates.motor_friction.valid]
        };
        assert_eq!((is_valid(1.9), is_valid(2.1)), ([true; 2], [false; 2]));
    }

    #[test]
    fn fraction_within_turn_is_kept() {
        assert_eq!(into_turn(3, 0.25_f32), (3, 0.25));
        assert_eq!(into_turn(3, 0.0_f32), (3, 0.0));
    }

    #[test]
    fn fraction_beyond_turn_is_normalised() {
        assert_eq!(into_turn(3, 1.25_f32), (4, 0.25));
        assert_eq!(into_turn(3, 1.0_f32), (4, 0.0));
        assert_eq!(into_turn(3, -0.25_f32), (2, 0.75));
        assert_eq!(into_turn(i32::MAX, 1.5_f32).0, i32::MIN);
    }

    #[test]
    fn hold_invalidates_and_keeps_values() {
        let mut estimates = Estimates::<f32> { contact_valid: true, settled: true, ..Estimates::default() };
        estimates.gap = Estimate { value: 1.0, variance: 2.0, valid: true };
        hold(&mut estimates, MotorFault::Frozen);
        assert_eq!(estimates.source, Source::Nothing(MotorFault::Frozen));
        assert_eq!(estimates.gap, Estimate { value: 1.0, variance: 2.0, valid: false });
        assert!(!estimates.contact_valid && !estimates.settled);
    }
}

//! Conversion of the observer's state to published estimates: values in the user's units, variances (O18, O19, O20) and
//! validity flags.

use super::contact::Contact;
use super::estimates::{Estimate, Estimates, MotorFault, Shaft, Source};
use super::filters::Filters;
use super::health::Health;
use super::learnt::Learnt;
use super::learnt::fusion::Fused;
use super::learnt::regressors::{MAPPED, OFFSET, SKEW};
use super::sensors::Sensors;
use super::sensors::counts::Counter;
use super::tables::{EncoderTable, ObserverTables};
use crate::gears::contact_state;
use crate::numbers::Real;

/// Limits of the variances of valid parameters.
trait Validity: Real {
    /// Largest standard deviation of a valid half-backlash and of a valid encoder offset, over the half-gap [-]: two
    /// standard deviations move a flank by a quarter of the half-gap.
    const HALF_GAP: Self = Self::EIGHTH;
    /// Largest variance of a valid compliance over the squared compliance [-]: a standard deviation of 22 %.
    const COMPLIANCE: Self = Self::TWENTIETH;
    /// Largest variance of valid bias and friction over their initial variance [-].
    const BIAS: Self = Self::HALF;
}

impl<T: Real> Validity for T {}

/// Parts of the observer from which the estimates of a period are computed.
#[derive(Clone, Copy)]
pub(super) struct State<'now, T: Real, const P: usize> {
    pub tables: &'now ObserverTables<T>,
    pub sensors: &'now Sensors,
    pub filters: &'now Filters<T>,
    pub contact: &'now Contact,
    pub learnt: &'now Learnt<T, P>,
    pub health: &'now Health<T>,
}

impl<T: Real, const P: usize> State<'_, T, P> {
    /// Publishes the estimates of a period.
    #[inline]
    pub fn say(&self, fused: &Fused<T>, estimates: &mut Estimates<T>) {
        let tables = self.tables;
        let both = self.health.both_encoders();
        let touching = self.contact.reported.is_some();
        let gap = self.gap(fused, both, touching);
        let (motor, link) = self.shafts(both);
        let [sine, cosine] = self.learnt.errors.mesh;
        let slope = self.learnt.transmission_error(&[cosine, -sine]) * tables.counts.mesh_periods;

        estimates.source = self.health.source();
        estimates.gap = gap;
        estimates.gap_rate = if touching { T::ZERO } else { fused.rate };
        estimates.flank_shift = fused.flank_shift;
        estimates.flank_shift_slope = slope;
        estimates.contact = contact_state(self.contact.by_force.flank);
        estimates.reported_contact = contact_state(self.contact.reported);
        // A reported flank needs no valid gap coordinate: without a half-gap or an output encoder, force alone decides.
        // Flanks that the transmission error shifts over the middle of the gap hammer at every tooth: each contact ends
        // before a controller could react.
        estimates.contact_valid = (touching || gap.valid) && !self.learnt.uncertainty.flanks_swap;
        estimates.mesh_torque.valid = estimates.contact_valid;
        estimates.load_torque.value = self.filters.load.torque * estimates.link_inertia_ratio.value;
        estimates.load_torque.valid = both || touching;
        estimates.motor_lead = (fused.deflection + self.learnt.learner.value(OFFSET)) * tables.levers.per_output;
        estimates.motor = motor;
        estimates.link = link;
    }

    /// Computes the gap coordinate (O8) with its variance (O18, O19).
    #[inline]
    fn gap(&self, fused: &Fused<T>, both: bool, touching: bool) -> Estimate<T> {
        let tables = self.tables;
        let known = &self.learnt.uncertainty;
        let (value, variance) = if !both {
            self.gap_unseen(fused, touching)
        } else if known.half_gap_serves {
            let [touches, open] = known.gap_variance;
            // The estimate must last until the next period, during which teeth in the open gap move on.
            let goes_on = fused.rate * tables.period;
            let variance = if touching { touches } else { open + goes_on * goes_on };
            (fused.flank_shift + self.learnt.position(fused.of_teeth(), T::ZERO).gap(known.mesh_share), variance)
        } else {
            // Without a half-gap the wind-up of the force is subtracted.
            let [_, compliance] = self.learnt.shape();
            let wind_up = compliance - tables.learner.mesh_compliance;
            let of_wind_up = wind_up * known.force_deviation;
            let force = if touching { fused.force } else { T::ZERO };
            let noise = tables.contact.deflection_variance;
            (fused.deflection - wind_up * force, known.deflection_variance + noise + of_wind_up * of_wind_up)
        };
        let valid = variance < known.widest_variance && !self.health.is_at_odds(tables);
        Estimate { value, variance, valid }
    }

    /// Computes gap coordinate and variance (O26) without an output encoder.
    #[cold]
    fn gap_unseen(&self, fused: &Fused<T>, touching: bool) -> (T, T) {
        let [half_gap, _] = self.learnt.shape();
        let (upper, lower) = (fused.flank_shift + half_gap, fused.flank_shift - half_gap);
        let value = if let Some(felt) = self.health.motor_only.felt {
            let force = if touching { fused.force } else { T::ZERO };
            fused.flank_shift + felt.sign::<T>() * half_gap + self.tables.learner.mesh_compliance * force
        } else if fused.deflection > upper {
            upper
        } else if fused.deflection < lower {
            lower
        } else {
            fused.deflection
        };
        let variance = self.health.motor_only.gap_variance(self.tables, self.learnt);
        (value, variance.unwrap_or(half_gap * half_gap))
    }

    /// Computes both shafts, without the estimated encoder errors.
    #[inline]
    fn shafts(&self, both: bool) -> (Shaft<T>, Shaft<T>) {
        let (tables, counts) = (self.tables, &self.sensors.counts);
        let (drive, load) = (&self.filters.drive, &self.filters.load);
        let levers = &tables.levers;
        let (output, _) = counts.used();
        let late = if both { load.speed * self.learnt.learner.value(SKEW) } else { T::ZERO };
        let (motor_error, output_error) = if P == MAPPED {
            let [of_motor, of_output] = self.learnt.errors.errors;
            (of_motor * levers.per_sun, (late + of_output) * levers.per_output)
        } else {
            (T::ZERO, late * levers.per_output)
        };
        let motor = shaft(&tables.counts.motor, &counts.motor, drive.ahead - motor_error, drive.speed);
        let link = shaft(&tables.counts.output, output, load.ahead + output_error, load.speed);
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
pub(super) fn say_learnt<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    learnt: &Learnt<T, P>,
    both: bool,
    estimates: &mut Estimates<T>,
) {
    let levers = &tables.levers;
    let known = &learnt.uncertainty;
    let [half_gap, compliance] = learnt.shape();
    let (offset, skew) = (learnt.learner.value(OFFSET), learnt.learner.value(SKEW));
    let [half_gap_variance, offset_variance, compliance_variance, skew_variance] = known.variances;
    let [bias_variance, friction_variance, _] = learnt.bias.variance;
    let output_squared = levers.per_output * levers.per_output;
    let sun_squared = levers.sun * levers.sun;
    let [_, of_flank] = known.wind_up_variance;
    let half_gap_variance = half_gap_variance + of_flank;
    let here = half_gap_variance + learnt.variation(tables);
    let rough = T::HALF_GAP * half_gap;
    let bias_known = T::BIAS * tables.contact.bias_prior;
    let force_deviation = if both && known.half_gap_serves { known.both_deviation } else { known.force_deviation };
    let mesh_deviation = force_deviation * levers.output;
    let [_, load_variance] = tables.load.variance;

    estimates.settled = known.settled;
    estimates.mesh_torque.variance = mesh_deviation * mesh_deviation;
    estimates.load_torque.variance = load_variance;
    estimates.half_backlash_usable = half_gap > T::ZERO && half_gap_variance < rough * rough;
    estimates.half_backlash = Estimate {
        value: half_gap * T::HALF,
        variance: here * T::HALF * T::HALF,
        valid: half_gap > T::ZERO && here < rough * rough,
    };
    estimates.encoder_offset = Estimate {
        value: offset * levers.per_output,
        variance: offset_variance * output_squared,
        valid: both && offset_variance < rough * rough,
    };
    estimates.compliance = Estimate {
        value: compliance * output_squared,
        variance: compliance_variance * output_squared * output_squared,
        valid: compliance_variance < T::COMPLIANCE * compliance * compliance,
    };
    estimates.skew =
        Estimate { value: skew * levers.per_output, variance: skew_variance * output_squared, valid: both };
    let [value, variance] = learnt.inertia.ratio();
    estimates.link_inertia_ratio = Estimate { value, variance, valid: variance < tables.inertia.known * value * value };
    estimates.torque_bias = Estimate {
        value: learnt.bias.bias * levers.sun,
        variance: bias_variance * sun_squared,
        valid: bias_variance < bias_known,
    };
    estimates.motor_friction = Estimate {
        value: learnt.bias.friction * levers.sun,
        variance: friction_variance * sun_squared,
        valid: friction_variance < bias_known,
    };
}

/// Builds a shaft from its counts and the angle beyond the counts [rad].
fn shaft<T: Real>(table: &EncoderTable<T>, counter: &Counter, beyond: T, speed: T) -> Shaft<T> {
    let fraction = T::from_i32(counter.place() as i32) * table.fraction + beyond * table.turns;
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

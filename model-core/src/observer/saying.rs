//! From what the observer holds to what it says: values in the user's units, their variances, and whether it stands by
//! them. Nothing is decided or learnt here.

use super::contact::sign;
use super::counts::Counter;
use super::now::Now;
use super::regressors::{MAPPED, OFFSET, SKEW};
use super::state::Observer;
use crate::numbers::Real;
use crate::observer::estimates::{Estimate, Shaft, Source};
use crate::observer::tables::EncoderTable;
use parameters::ContactState;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Everything for a controller.
    pub(super) fn say(&mut self, now: &Now<T>) {
        let tables = self.tables;
        let both = self.supervisor.sees_both();
        let touching = self.estimates.reported_contact != ContactState::Separated;
        let gap = self.gap(now, both, touching);
        let (motor, link) = self.shafts(both);
        let [sine, cosine] = self.places.mesh;
        let slope = self.error(&[cosine, -sine]) * tables.counts.mesh_periods;

        let estimates = &mut self.estimates;
        estimates.source = self.supervisor.source();
        estimates.gap = gap;
        estimates.gap_rate = if touching { T::ZERO } else { now.rate };
        estimates.flank_shift = now.shift;
        estimates.flank_shift_slope = slope;
        // Without a width, force alone decides, and what it says is sure; so it is without an output encoder.
        // Flanks that the transmission error shifts over the middle of the gap hammer at every tooth: what touches now is
        // over before anyone could act on it.
        estimates.contact_valid = (touching || gap.valid) && !self.knowledge.flanks_swap;
        estimates.mesh_torque.valid = estimates.contact_valid;
        estimates.load_torque.value = self.load.torque * estimates.link_inertia_ratio.value;
        estimates.load_torque.valid = both || touching;
        estimates.motor = motor;
        estimates.link = link;
    }

    /// Nothing has been heard of the motor: everything is held.
    #[cold]
    pub(super) fn hold(&mut self) {
        self.drive.hold();
        self.estimates.source = Source::Nothing;
        self.vouch_for_nothing();
    }

    /// What was said stays, but may be wrong.
    #[cold]
    pub(super) fn vouch_for_nothing(&mut self) {
        let estimates = &mut self.estimates;
        estimates.contact_valid = false;
        estimates.settled = false;
        for estimate in [&mut estimates.gap, &mut estimates.mesh_torque, &mut estimates.load_torque] {
            estimate.valid = false;
        }
    }

    /// What is learnt slowly, once an interval.
    pub(super) fn say_learnt(&mut self) {
        let tables = self.tables;
        let levers = &tables.levers;
        let known = &self.knowledge;
        let both = self.supervisor.sees_both();
        let [half_gap, compliance] = self.shape();
        let (offset, skew) = (self.learner.value(OFFSET), self.learner.value(SKEW));
        let [half_gap_variance, offset_variance, compliance_variance, skew_variance] = known.variances;
        let [bias_variance, friction_variance, _] = self.bias.variance;
        let output_squared = levers.per_output * levers.per_output;
        let sun_squared = levers.sun * levers.sun;
        let [_, of_flank] = known.wind_up_variance;
        let half_gap_variance = half_gap_variance + of_flank;
        let rough = T::EIGHTH * half_gap;
        let bias_known = T::HALF * tables.contact.bias_prior;
        let force_deviation = if both && known.width_serves { known.both_deviation } else { known.force_deviation };
        let mesh_deviation = force_deviation * levers.output;
        let [_, load_variance] = tables.load.variance;

        let estimates = &mut self.estimates;
        estimates.settled = known.settled;
        estimates.mesh_torque.variance = mesh_deviation * mesh_deviation;
        estimates.load_torque.variance = load_variance;
        estimates.half_backlash = Estimate {
            value: half_gap * T::HALF,
            variance: half_gap_variance * T::HALF * T::HALF,
            valid: half_gap > T::ZERO && half_gap_variance < rough * rough,
        };
        estimates.encoder_offset = Estimate {
            value: offset * levers.per_output,
            variance: offset_variance * output_squared,
            valid: both && offset_variance < rough * rough,
        };
        estimates.compliance = Estimate {
            value: compliance * output_squared,
            variance: compliance_variance * output_squared * output_squared,
            valid: compliance_variance < T::TWENTIETH * compliance * compliance,
        };
        estimates.skew =
            Estimate { value: skew * levers.per_output, variance: skew_variance * output_squared, valid: both };
        let [value, variance] = self.inertia.ratio();
        estimates.link_inertia_ratio =
            Estimate { value, variance, valid: variance < tables.inertia.known * value * value };
        estimates.torque_bias = Estimate {
            value: self.bias.bias * levers.sun,
            variance: bias_variance * sun_squared,
            valid: bias_variance < bias_known,
        };
        estimates.motor_friction = Estimate {
            value: self.bias.friction * levers.sun,
            variance: friction_variance * sun_squared,
            valid: friction_variance < bias_known,
        };
    }

    /// Gap coordinate with its variance.
    fn gap(&self, now: &Now<T>, both: bool, touching: bool) -> Estimate<T> {
        let tables = self.tables;
        let known = &self.knowledge;
        let (value, variance) = if !both {
            self.gap_unseen(now, touching)
        } else if known.width_serves {
            let [touches, open] = known.gap_variance;
            // What is said must last until the next period: teeth on their way do not stand still.
            let goes_on = now.rate * tables.period;
            let variance = if touching { touches } else { open + goes_on * goes_on };
            (now.shift + self.by_position(now.way, T::ZERO, now.shift).gap(known.mesh_share), variance)
        } else {
            // Without a width: less the wind-up of the force.
            let [_, compliance] = self.shape();
            let wind_up = compliance - tables.learner.mesh_compliance;
            let of_wind_up = wind_up * known.force_deviation;
            let force = if touching { now.force } else { T::ZERO };
            let noise = tables.contact.way_variance;
            (now.way - wind_up * force, known.way_variance + noise + of_wind_up * of_wind_up)
        };
        let valid = variance < known.widest_variance && !self.supervisor.is_at_odds(&tables.supervisor);
        Estimate { value, variance, valid }
    }

    /// The same without an output encoder.
    #[cold]
    fn gap_unseen(&self, now: &Now<T>, touching: bool) -> (T, T) {
        let [half_gap, _] = self.shape();
        let (upper, lower) = (now.shift + half_gap, now.shift - half_gap);
        let felt: T = sign(self.blind.felt);
        let value = if felt != T::ZERO {
            let force = if touching { now.force } else { T::ZERO };
            now.shift + felt * half_gap + self.tables.learner.mesh_compliance * force
        } else if now.way > upper {
            upper
        } else if now.way < lower {
            lower
        } else {
            now.way
        };
        (value, self.blind_variance().unwrap_or(half_gap * half_gap))
    }

    /// Both shafts, less the encoder errors that were learnt.
    fn shafts(&self, both: bool) -> (Shaft<T>, Shaft<T>) {
        let tables = self.tables;
        let levers = &tables.levers;
        let (output, _) = self.counts.used();
        let late = if both { self.load.speed * self.learner.value(SKEW) } else { T::ZERO };
        let (motor_error, output_error) = if P == MAPPED {
            let [of_motor, of_output] = self.places.errors;
            (of_motor * levers.per_sun, (late + of_output) * levers.per_output)
        } else {
            (T::ZERO, late * levers.per_output)
        };
        let motor = shaft(&tables.counts.motor, &self.counts.motor, self.drive.ahead - motor_error, self.drive.speed);
        let link = shaft(&tables.counts.output, output, self.load.ahead + output_error, self.load.speed);
        (motor, link)
    }
}

/// A shaft from its counts and the angle beyond them.
fn shaft<T: Real>(table: &EncoderTable<T>, counter: &Counter, beyond: T, speed: T) -> Shaft<T> {
    let fraction = T::from_i32(counter.place() as i32) * table.fraction + beyond * table.turns;
    let (turns, fraction) = if fraction < T::ZERO {
        (counter.turns().wrapping_sub(1), fraction + T::ONE)
    } else if fraction >= T::ONE {
        (counter.turns().wrapping_add(1), fraction - T::ONE)
    } else {
        (counter.turns(), fraction)
    };
    Shaft { turns, fraction, speed }
}

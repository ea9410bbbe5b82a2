//! From what the observer holds to what it says: values in the user's units, their variances, and whether it stands by
//! them. Nothing is decided or learnt here.

use super::contact::sign;
use super::counts::Counter;
use super::regressors::{ERROR, MAP, OFFSET, SKEW};
use super::{MAPPED, Now, Observer, PLAIN, Source};
use crate::mesh::ContactState;
use crate::real::Real;
use crate::realtime::observer::{Estimate, Shaft};
use crate::tables::observer::EncoderTable;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Everything for a controller.
    pub(super) fn say(&mut self, now: &Now<T, P>) {
        let tables = self.tables;
        let levers = &tables.levers;
        let known = &self.knowledge;
        let both = self.supervisor.source() == Source::Both;
        let touching = self.estimates.reported_contact != ContactState::Separated;
        let [half_gap, _] = self.shape();
        let gap = self.gap(now, both, touching, half_gap);
        let rate = if touching { T::ZERO } else { now.rate };
        let [_, load_variance] = tables.load.variance;
        let force_deviation = if both && known.width_serves { known.both_deviation } else { known.force_deviation };
        let mesh_deviation = force_deviation * levers.output;
        let (motor, link) = self.shafts(now, both);
        let [sine, cosine] = now.mesh;
        let slope = self.error(&[cosine, -sine]) * T::from_i32(tables.counts.meshes as i32);
        let swap = self.flanks_swap();

        let estimates = &mut self.estimates;
        estimates.source = self.supervisor.source();
        estimates.gap = gap;
        estimates.gap_rate = rate;
        estimates.flank_shift = now.shift;
        estimates.flank_shift_slope = slope;
        // Without a width, force alone decides, and what it says is sure; so it is without an output encoder.
        // Flanks that the transmission error shifts over the middle of the gap hammer at every tooth: what touches now is
        // over before anyone could act on it.
        estimates.contact_valid = (touching || gap.valid) && !swap;
        estimates.mesh_torque.variance = mesh_deviation * mesh_deviation;
        estimates.mesh_torque.valid = estimates.contact_valid;
        estimates.load_torque = Estimate { value: self.load.torque, variance: load_variance, valid: both || touching };
        estimates.motor = motor;
        estimates.link = link;
    }

    /// Whether the transmission error shifts a flank over the middle of the gap.
    fn flanks_swap(&self) -> bool {
        let [half_gap, _] = self.shape();
        let [sine, cosine] = [self.learner.value(ERROR), self.learner.value(ERROR + 1)];
        sine * sine + cosine * cosine > half_gap * half_gap
    }

    /// What is learnt slowly, once an interval.
    pub(super) fn say_learnt(&mut self) {
        let tables = self.tables;
        let levers = &tables.levers;
        let known = &self.knowledge;
        let both = self.supervisor.source() == Source::Both;
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

        let estimates = &mut self.estimates;
        estimates.settled = known.settled;
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
    fn gap(&self, now: &Now<T, P>, both: bool, touching: bool, half_gap: T) -> Estimate<T> {
        let tables = self.tables;
        let known = &self.knowledge;
        let position = self.by_position(now.way, T::ZERO, now.shift);
        let wind_up = position.compliance - tables.learner.mesh_compliance;
        let force = if touching { now.force } else { T::ZERO };
        let noise = tables.contact.way_variance;
        let (value, variance) = if !both {
            let (upper, lower) = (now.shift + half_gap, now.shift - half_gap);
            let edge = if now.way > upper {
                upper
            } else if now.way < lower {
                lower
            } else {
                now.way
            };
            let felt: T = sign(self.blind.felt);
            let value = if felt == T::ZERO {
                edge
            } else {
                now.shift + felt * half_gap + tables.learner.mesh_compliance * force
            };
            (value, self.blind_variance())
        } else if known.width_serves {
            // What is said must last until the next period: teeth on their way do not stand still.
            let goes_on = now.rate * tables.period;
            let [of_way, of_flank] = known.wind_up_variance;
            let variance = if touching {
                known.flank_variance + of_flank
            } else {
                known.way_variance + of_way + goes_on * goes_on
            };
            (position.gap(tables.learner.mesh_compliance), Some(variance + noise))
        } else {
            // Without a width: less the wind-up of the force.
            let of_wind_up = wind_up * known.force_deviation;
            (now.way - wind_up * force, Some(known.way_variance + noise + of_wind_up * of_wind_up))
        };
        let widest = tables.supervisor.widest_part * (half_gap + half_gap);
        Estimate {
            value,
            variance: variance.unwrap_or(half_gap * half_gap),
            valid: half_gap > T::ZERO
                && !self.supervisor.is_at_odds(&tables.supervisor)
                && variance.is_some_and(|variance| variance < widest * widest),
        }
    }

    /// Both shafts, less the encoder errors that were learnt.
    fn shafts(&self, now: &Now<T, P>, both: bool) -> (Shaft<T>, Shaft<T>) {
        let tables = self.tables;
        let levers = &tables.levers;
        let (output, _) = self.counts.used();
        let part = |from: usize| {
            let values = self.learner.values.iter().skip(from).take(MAP);
            values.zip(now.free.iter().skip(from)).fold(T::ZERO, |sum, (value, regressor)| sum + *value * *regressor)
        };
        let (motor_error, output_error) = if P == MAPPED {
            (part(PLAIN) * levers.per_sun, -part(PLAIN + MAP) * levers.per_output)
        } else {
            (T::ZERO, T::ZERO)
        };
        let late = if both { self.load.speed * self.learner.value(SKEW) * levers.per_output } else { T::ZERO };
        let motor = shaft(&tables.counts.motor, &self.counts.motor, self.drive.ahead - motor_error, self.drive.speed);
        let link = shaft(&tables.counts.output, output, self.load.ahead + late - output_error, self.load.speed);
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

//! Decisions on a dwell, in this order: does an interval belong to a dwell, on which flank, does the mean of the dwell
//! agree with the parameters, and which consequence has a disagreement.

use super::consistency::{DeviationSize, ParameterAction};
use super::flank;
use super::interval::{Dwell, is_settled};
use super::regressors::Regressors;
use super::thresholds::CONSISTENCY;
use super::travel::Travel;
use super::trusted_parameters::TrustedParameters;
use super::{IntervalResult, ParameterEstimator};
use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::observer::tables::ObserverTables;

impl<T: Real, const P: usize> ParameterEstimator<T, P> {
    /// Decides if an interval is a dwell that updates the parameters, and on which flank; the force rises by `rise`
    /// [N].
    pub(super) fn dwell(
        &mut self,
        tables: &ObserverTables<T>,
        interval: &IntervalResult<T>,
        rise: T,
        both_encoders: bool,
    ) -> Dwell {
        let [half_gap, _] = self.half_gap_and_compliance();
        let known = self.uncertainty.half_gap_is_known;
        // Teeth at rest while the motor turns are on a flank, even if no force shows which. While the transmission
        // error could hide a crossing, this is not certain of any rest: the transmission error is estimated first.
        let half_gap_bound = self.last_dwell.co_motion().half_gap_at_least(half_gap);
        let rests_on_unknown_flank = is_settled(interval.travel)
            && !known
            && (interval.error_deviation > half_gap_bound * Self::LIMITS.hidden_crossing
                || self.travel.distinguishes_rest(half_gap_bound));
        // A stationary motor repeats one rounded reading under a force hidden by friction: this dwell is used once on
        // either flank.
        let turns = interval.mean.direction.abs() > T::HALF;
        let evidence = self.flank_evidence(interval.deflection - interval.flank_shift, interval.mean.force);
        let loaded_flank = flank::loaded_flank(&evidence, &self.interval, &tables.learner, rise);
        // The first millisecond of a landing is not used.
        let confirmed_flank = loaded_flank.filter(|_| loaded_flank == self.interval.loaded_flank);
        let known_flank = interval.flank.or(confirmed_flank);
        self.interval.loaded_flank = loaded_flank;
        let new = turns || known_flank.is_some() && known_flank != self.interval.updated_on;
        if both_encoders && new && (known_flank.is_some() || rests_on_unknown_flank) {
            Dwell::On(known_flank)
        } else {
            Dwell::No
        }
    }

    /// Detects force at rest between the flanks beyond bias and stiction, and grades the distance from the flanks.
    pub(super) fn force_between_flanks(
        &self,
        tables: &ObserverTables<T>,
        deflection: T,
        travel: Travel<T>,
    ) -> Option<DeviationSize> {
        let known = &self.uncertainty;
        let [half_gap, _] = self.half_gap_and_compliance();
        let threshold = T::THREE * known.steady_force_deviation + T::TWO * self.bias.friction.abs();
        let inside = half_gap - known.blur - tables.rounding();
        let between = known.half_gap_is_known && deflection.abs() < inside;
        let deviation = if half_gap - deflection.abs() < Self::LIMITS.max_variation * half_gap {
            DeviationSize::WithinVariation
        } else {
            DeviationSize::BeyondVariation
        };
        (between && is_settled(travel) && self.interval.steady_force.abs() > threshold).then_some(deviation)
    }

    /// Determines the flank of a dwell, by force or by the change of the deflection.
    pub(super) fn determine_flank(&mut self, tables: &ObserverTables<T>) {
        let (regressors, deflection) = self.batch.measurement();
        let mut flank = self.batch.flank();
        if let Some(known_flank) = flank {
            self.last_dwell.co_motion().confirm_flank(known_flank);
        } else {
            flank = self.flank_without_force(tables, &regressors, deflection);
        }
        self.last_dwell.store(&regressors, deflection, flank);
        self.batch.set_flank(flank);
    }

    /// Determines the flank of a dwell by the deflection. If the flank stays unknown but the teeth certainly are on a
    /// flank, the dwell updates the parameters that do not depend on the flank.
    fn flank_without_force(
        &mut self,
        tables: &ObserverTables<T>,
        regressors: &Regressors<T, P>,
        deflection: T,
    ) -> Option<Flank> {
        let [half_gap, _] = self.half_gap_and_compliance();
        let innovation = self.last_dwell.innovation(&tables.learner, &self.least_squares, regressors, deflection)?;
        let flank = self.last_dwell.flank(&tables.learner, &innovation, regressors, half_gap, tables.levers.output);
        if self.travel.distinguishes_rest(self.last_dwell.co_motion().half_gap_at_least(half_gap)) {
            // Teeth also reverse inside the gap, for a moment at rest: then the force of the whole dwell shows no stop.
            // Teeth also leave a flank slowly, at rest for a while: then the steady force has decayed.
            let force =
                if self.last_dwell.was_on(flank) { self.interval.steady_force } else { self.interval.dwell_force };
            let is_felt = sign::<T>(flank) * force > self.uncertainty.steady_force_deviation;
            let flank = if is_felt { flank } else { self.last_dwell.co_motion().flank() };
            if flank.is_some() {
                return flank;
            }
        }
        if innovation.is_within(CONSISTENCY.outlier_sigma) && self.last_dwell.co_motion().proves_contact(half_gap) {
            self.pending_innovation = Some(innovation);
        }
        None
    }

    /// Accepts a dwell on a flank as a measurement, or rejects it as an outlier.
    pub(super) fn check_dwell(&mut self, tables: &ObserverTables<T>) -> ParameterAction {
        let table = &tables.learner;
        let [half_gap, _] = self.half_gap_and_compliance();
        let (regressors, deflection) = self.batch.measurement();
        let relative_weight = self.batch.relative_weight(table, self.uncertainty.half_gap_is_known);
        let weight = (table.weight * relative_weight) / self.uncertainty.dwell_deviation;
        let innovation = self.least_squares.innovation(table, &regressors, deflection, weight);
        let square = innovation.value * innovation.value;
        let is_accepted = innovation.is_within(CONSISTENCY.outlier_sigma);
        if let Some(flank) = self.batch.flank() {
            let deviation = [square, innovation.variance].map(|normalised| normalised / (weight * weight));
            self.gap_variation.add_dwell(&tables.counts, flank, deviation, half_gap, is_accepted);
        }
        if !is_accepted {
            let excess = innovation.value.abs() / weight;
            let deviation = if excess <= half_gap * tables.contact.known_part {
                DeviationSize::WithinTolerance
            } else if excess < Self::LIMITS.max_variation * half_gap {
                DeviationSize::WithinVariation
            } else {
                DeviationSize::BeyondVariation
            };
            let action = self.consistency.reject(deviation, self.trusted.is_some());
            self.apply_action(tables, action);
            return action;
        }
        self.consistency.accept(self.batch.flank());
        self.pending_innovation = Some(innovation);
        ParameterAction::Keep
    }

    /// Updates the parameters with the accepted dwell, if any.
    pub(super) fn update_with_dwell(&mut self, tables: &ObserverTables<T>) {
        let Some(innovation) = self.pending_innovation.take() else { return };
        self.errors.update_parameters(&mut self.least_squares, |least_squares| {
            least_squares.update(&tables.learner, &innovation)
        });
        let Some(flank) = self.batch.flank() else { return };
        self.uncertainty.adapt_dwell_noise(innovation.value, innovation.variance, flank);
        if self.consistency.is_trusted() {
            self.trusted = Some(TrustedParameters::snapshot(&self.least_squares));
            if self.uncertainty.detect_half_gap_change() {
                self.least_squares.inflate_half_gap(&tables.learner, Self::LIMITS.inflation);
            }
        }
    }

    /// Applies an action: resets the variances of the parameters concerned.
    pub(super) fn apply_action(&mut self, tables: &ObserverTables<T>, action: ParameterAction) {
        match action {
            ParameterAction::Keep | ParameterAction::OutputEncoderFault => {}
            ParameterAction::InflateHalfGap => {
                self.least_squares.inflate_half_gap(&tables.learner, Self::LIMITS.inflation)
            }
            ParameterAction::ResetHalfGap => self.least_squares.reset_half_gap_variance(),
            ParameterAction::ResetAll => self.least_squares.reset_covariance(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::batch::IntervalSample;
    use super::super::interval::IntervalMean;
    use super::super::regressors::{HALF_GAP, PLAIN, open_gap};
    use super::*;
    use crate::observer::test_tables::{contact, estimator, observer};

    type Estimator = ParameterEstimator<f32, PLAIN>;

    /// Estimator whose half-gap of 80 um has been trusted on both flanks.
    fn trusted(tables: &ObserverTables<f32>) -> Estimator {
        let mut estimator = estimator(tables);
        for _ in 0..CONSISTENCY.trusted_dwells {
            estimator.consistency.accept(Some(Flank::Drive));
            estimator.consistency.accept(Some(Flank::Back));
        }
        estimator
    }

    /// Decision on a dwell that shows a half-gap on the drive flank wider by `excess` [m]; the noise is 1 um.
    fn dwell_beyond(estimator: &mut Estimator, tables: &ObserverTables<f32>, excess: f32) -> ParameterAction {
        let open_gap = open_gap(0.0, 0, None);
        let sample =
            IntervalSample { open_gap: &open_gap, mesh: &[0.0; 2], raw_deflection: 80e-6 + excess, force: 0.0 };
        for _ in 0..tables.learner.block {
            estimator.batch.add(&sample, Dwell::On(Some(Flank::Drive)), 2, &tables.learner);
        }
        estimator.check_dwell(tables)
    }

    #[test]
    fn dwell_within_five_sigma_is_accepted() {
        let tables = observer();
        let is_accepted = |excess| {
            let mut estimator = estimator(&tables);
            dwell_beyond(&mut estimator, &tables, excess);
            estimator.pending_innovation.is_some()
        };
        assert!(is_accepted(4.9e-6) && is_accepted(-4.9e-6));
        assert!(!is_accepted(5.1e-6) && !is_accepted(-5.1e-6));
    }

    #[test]
    fn dwell_off_by_three_eighths_is_variation() {
        let tables = observer();
        let second_outlier = |excess| {
            let mut estimator = trusted(&tables);
            assert_eq!(dwell_beyond(&mut estimator, &tables, excess), ParameterAction::Keep);
            dwell_beyond(&mut estimator, &tables, excess)
        };
        // 30 um of a half-gap of 80 um.
        assert_eq!(second_outlier(29e-6), ParameterAction::InflateHalfGap);
        assert_eq!(second_outlier(31e-6), ParameterAction::ResetHalfGap);
    }

    #[test]
    fn force_in_gap_is_graded_by_distance() {
        let tables = observer();
        let mut estimator = estimator(&tables);
        estimator.uncertainty.steady_force_deviation = 1.0;
        estimator.interval.steady_force = 10.0;
        let at = |deflection| estimator.force_between_flanks(&tables, deflection, Travel::AtRest(10));
        // 29 um and 31 um away from the flank.
        assert_eq!(at(51e-6), Some(DeviationSize::WithinVariation));
        assert_eq!(at(49e-6), Some(DeviationSize::BeyondVariation));
    }

    #[test]
    fn variation_adds_an_eighth_of_half_gap() {
        let tables = observer();
        let mut estimator = estimator(&tables);
        estimator.apply_action(&tables, ParameterAction::InflateHalfGap);
        let deviation = estimator.least_squares.variance_of(&tables.learner, HALF_GAP).square_root();
        assert!((deviation - 10e-6).abs() < 0.1e-6, "{deviation}");
    }

    #[test]
    fn hidden_crossing_makes_rest_a_dwell() {
        let tables = observer();
        let dwell = |error_deviation| {
            let mut estimator = estimator(&tables);
            estimator.uncertainty.half_gap_is_known = false;
            // Unknown error maps of 1 mm hide each crossing.
            for _ in 0..9 {
                estimator.travel.step(&contact(), 0.0, (0.0, 0.0), 1e-3, 0.0);
            }
            let mean = IntervalMean { raw_deflection: 0.0, motor_force: 0.0, force: 0.0, direction: 1.0 };
            let (travel, flank) = (Travel::AtRest(10), None);
            let interval = IntervalResult {
                mean,
                mesh: [0.0; 2],
                deflection: 0.0,
                flank_shift: 0.0,
                travel,
                flank,
                error_deviation,
            };
            estimator.dwell(&tables, &interval, 0.0, true)
        };
        // A quarter of the half-gap of 80 um.
        assert_eq!((dwell(19e-6), dwell(21e-6)), (Dwell::No, Dwell::On(None)));
    }
}

//! Faults of the output encoder:
//!
//! ```text
//! (O23) |d_t| < wind-up + c + 3 sigma(edge) + 0.1 (c + κ F_max)
//! (O24) |change of d_t less wind-up| > 2 (c + 3 sigma(c) + 0.1 (c + κ F_max) + 2 sigma(κ) |F|) + 1 count
//! ```
//!
//! Symbols: d_t = `deflection`, c + 3 sigma(edge) + 0.1 (...) = `Uncertainty::reach`, change of d_t = `travel`, 0.1 (c
//! + κ F_max) = `margin`, 2 sigma(κ) = `compliance_uncertainty`.
//!
//! The first check that fails excludes the encoder:
//!
//! | # | found by | condition | purpose | needed by |
//! |---|---|---|---|---|
//! | 1 | counts that jumped for good ([`CountChange::Jumped`]) | readings farther apart than any motor turns | a lost reference, a wrong absolute word | `observer faults::output_fault_at_speed_is_excluded_in_1_ms` |
//! | 2 | [`Plausibility`]: counts that jump | a few readings that confirm the jump | a slipped coupling, an offset; acts before the deflection is corrupted | `observer faults::output_fault_at_speed_is_excluded_in_1_ms` |
//! | 3 | [`Plausibility`]: counts that stand still at once | fewer counts than any stop explains | a frozen encoder in motion, within a few periods | `observer faults::output_fault_at_speed_is_excluded_in_1_ms` |
//! | 4 | silence ([`OutputFault::Silent`]) | no fresh reading for 10 ms | a broken line | `observer faults::silent_output_is_reported_and_readmitted` |
//! | 5 | the motor outruns counts that stand still | more than gap and wind-up, for 4 ms | an encoder that froze in slow motion or at rest | `observer faults::motor_travel_reveals_frozen_output` |
//! | 6 | a deflection that no teeth allow | out of range for 4 ms, longer than impacts ring | all other faults: slow slip, missing counts | `observer faults::lost_counts_keep_half_backlash_positive` |
//! | 7 | teeth that seem to have grown, or shafts to have turned against each other ([`identification::Outcome::OutputEncoderFault`]) | a half-gap trusted on both flanks | missing counts that stay within the gap | `observer faults::narrowing_output_is_excluded` |
//!
//! [`identification::Outcome::OutputEncoderFault`]: crate::observer::identification::Outcome::OutputEncoderFault

use super::plausibility::{MotionLimits, Plausibility, PlausibilityResult, counts};
use super::thresholds::OUTPUT_FAULT;
use crate::estimates::OutputFault;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::identification::ParameterEstimator;
use crate::observer::identification::mesh_measurement::MeshMeasurement;
use crate::observer::sensors::SensorReadings;
use crate::observer::sensors::counts::CountChange;
use crate::observer::tables::{ObserverTables, StopTable, SupervisorTable};

/// Fault checks of the output encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct OutputFaultDetector<T: Real> {
    plausibility: Plausibility,
    silent_periods: u16,
    standstill_periods: u16,
    out_of_range_for: u16,
    /// Deflection of the teeth in the last period [m]. `has_jumped`: the deflection jumped to its present place, beyond
    /// its range or within the margin of its end.
    deflection: T,
    has_jumped: bool,
    /// Deflection less wind-up when the counts last changed [m].
    standstill_deflection: T,
    /// True if the deflection was unknown in the last period.
    deflection_unknown: bool,
}
state_words! {
    struct OutputFaultDetector<T> {
        plausibility, silent_periods, standstill_periods, out_of_range_for, deflection, has_jumped,
        standstill_deflection, deflection_unknown,
    }
}

/// An obstacle stops a link; nothing throws a link.
impl<T: Real> MotionLimits<T> for SupervisorTable<T> {
    fn stop_table(&self) -> &StopTable<T> {
        &self.output
    }

    fn half_deceleration(&self) -> T {
        self.output_brake
    }

    fn impact_speed_change(&self, _: i32) -> i32 {
        0
    }

    fn speed_kept_by_teeth(&self, _: i32) -> i32 {
        0
    }

    fn lower_speed_bound(&self, rate: i32) -> T {
        counts(rate)
    }
}

/// Result of screening a reading.
#[derive(Debug, Clone, Copy)]
pub enum ReadingStatus<T: Real> {
    /// First reading of the run; accepted.
    First,
    /// The reading is used.
    Accepted,
    /// The reading is missing or rejected.
    Rejected,
    /// The reading excludes the encoder. The last motion of the link is given if known.
    Excluded(OutputFault, Option<LastMotion<T>>),
}

/// Motion of the link when its readings broke off.
#[derive(Debug, Clone, Copy)]
pub struct LastMotion<T: Real> {
    /// Lead of the link over its last reading [counts].
    pub lead: T,
    /// Speed [counts per period].
    pub speed: T,
}

/// Range of a deflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DeflectionRange {
    /// Between the flanks, or beyond a flank by at most the wind-up.
    Possible,
    /// Past a flank by more than the wind-up, but by no more than wear.
    Worn,
    /// Past a flank by more than wear explains: teeth cannot deflect that far.
    Impossible,
}

impl<T: Real> OutputFaultDetector<T> {
    /// Starts the time out of range anew after an exclusion.
    pub fn reset_timer(&mut self) {
        self.out_of_range_for = 0;
    }

    /// Starts anew after an unknown deflection: counts that stood still did so at another deflection.
    pub fn resume_deflection(&mut self) {
        self.out_of_range_for = 0;
        self.deflection_unknown = true;
    }

    /// Returns true once the deflection has been out of range for 4 ms, longer than impacts ring.
    pub fn is_deflection_out_of_range(&self, table: &SupervisorTable<T>) -> bool {
        self.out_of_range_for >= table.failed_after
    }

    /// Speed of the link [parts of an output count per period].
    pub fn rate(&self) -> i32 {
        self.plausibility.rate()
    }

    /// Returns true if the last period had no reading.
    pub fn is_silent(&self) -> bool {
        self.silent_periods > 0
    }

    /// Judges the reading of one period by the readings before.
    // Inlined: a call and its result cost more than the work of most periods.
    #[inline(always)]
    pub fn check_reading(
        &mut self,
        tables: &ObserverTables<T>,
        readings: &SensorReadings<T>,
        both_encoders: bool,
    ) -> ReadingStatus<T> {
        let by = match readings.output {
            None => {
                self.silent_periods = self.silent_periods.saturating_add(1);
                return ReadingStatus::Rejected;
            }
            Some(CountChange::By(by)) => by,
            Some(advance) => return self.check_distant_reading(advance, both_encoders),
        };
        self.silent_periods = 0;
        self.standstill_periods = if by == 0 { self.standstill_periods.saturating_add(1) } else { 0 };
        let status = if both_encoders { ReadingStatus::Accepted } else { ReadingStatus::Rejected };
        let clock = &tables.clock;
        let beyond = readings.output_interval.wrapping_sub(clock.shortest);
        if beyond > clock.longer {
            self.plausibility.skip_irregular(by, beyond > clock.period.saturating_mul(OUTPUT_FAULT.speed_kept_periods));
            return status;
        }
        match self.plausibility.check(&tables.supervisor, by) {
            PlausibilityResult::Plausible => status,
            PlausibilityResult::Suspect => ReadingStatus::Rejected,
            PlausibilityResult::Implausible => self.exclude_implausible(both_encoders),
        }
    }

    /// Handles the first reading, and a reading far from the last one.
    #[cold]
    fn check_distant_reading(&mut self, advance: CountChange, both_encoders: bool) -> ReadingStatus<T> {
        self.silent_periods = 0;
        self.standstill_periods = 0;
        match advance {
            CountChange::First => ReadingStatus::First,
            CountChange::Jumped(_) if both_encoders => {
                self.plausibility.reset_speed();
                ReadingStatus::Excluded(OutputFault::OutOfRange, None)
            }
            CountChange::Jumped(_) | CountChange::Implausible | CountChange::By(_) => ReadingStatus::Rejected,
        }
    }

    /// Excludes the encoder after readings that no link can follow.
    #[cold]
    fn exclude_implausible(&mut self, both_encoders: bool) -> ReadingStatus<T> {
        let last = self.plausibility.speed().map(|speed| LastMotion { lead: self.plausibility.lead(), speed });
        let frozen = last.is_some() && self.plausibility.is_standstill();
        self.plausibility.reset_speed();
        if both_encoders {
            ReadingStatus::Excluded(if frozen { OutputFault::Frozen } else { OutputFault::OutOfRange }, last)
        } else {
            ReadingStatus::Rejected
        }
    }

    /// Judges the deflection. Worn teeth extend its range step by step; a slipping encoder makes the deflection jump. A
    /// link that sticks beyond a half-gap estimated too small looks like a frozen encoder until the deflection exceeds
    /// possible wear. `unwound_deflection` is the deflection less wind-up [m].
    pub fn check_deflection<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        measurement: &MeshMeasurement<T>,
        estimator: &ParameterEstimator<T, P>,
        unwound_deflection: T,
        both_encoders: bool,
    ) -> Option<OutputFault> {
        let table = &tables.supervisor;
        let deflection = measurement.tooth_deflection();
        let [half_gap, _] = estimator.half_gap_and_compliance();
        if self.standstill_periods == 0 || core::mem::take(&mut self.deflection_unknown) {
            self.standstill_deflection = unwound_deflection;
        }
        let by = deflection - core::mem::replace(&mut self.deflection, deflection);
        if !both_encoders {
            return None;
        }
        let travel = (unwound_deflection - self.standstill_deflection).abs();
        let range = if travel > half_gap && exceeds_gap(tables, estimator, travel, measurement.force) {
            DeflectionRange::Impossible
        } else if deflection.abs() < estimator.uncertainty.reach {
            DeflectionRange::Possible
        } else {
            classify_deflection(estimator, deflection, measurement.force)
        };
        // A deflection that jumps to the end of its range may continue beyond it.
        let is_near_end = deflection.abs() + table.margin > estimator.uncertainty.reach;
        self.has_jumped = is_near_end && (self.has_jumped || by.abs() > table.margin);
        let fault = if range == DeflectionRange::Possible {
            self.out_of_range_for = 0;
            None
        } else {
            self.count_out_of_range(table, range)
        };
        if self.silent_periods > table.silent_after { Some(OutputFault::Silent) } else { fault }
    }

    /// Counts one more period with the deflection out of range.
    #[cold]
    fn count_out_of_range(&mut self, table: &SupervisorTable<T>, range: DeflectionRange) -> Option<OutputFault> {
        self.out_of_range_for = self.out_of_range_for.saturating_add(1);
        if self.out_of_range_for < table.failed_after || range == DeflectionRange::Worn && !self.has_jumped {
            None
        } else if self.standstill_periods >= table.failed_after {
            Some(OutputFault::Frozen)
        } else {
            Some(OutputFault::OutOfRange)
        }
    }
}

/// Returns true if one shaft has moved by more than gap and wind-up allow while the other's counts stood still (O24).
/// The test needs no knowledge of the flank.
#[cold]
pub fn exceeds_gap<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    estimator: &ParameterEstimator<T, P>,
    travel: T,
    force: T,
) -> bool {
    let [half_gap, _] = estimator.half_gap_and_compliance();
    let [half_gap_variance, ..] = estimator.uncertainty.variances;
    let by_estimate = half_gap + T::THREE * half_gap_variance.square_root();
    let by_guess = estimator.uncertainty.guessed_half_gap;
    let widest = if by_guess > by_estimate { by_guess } else { by_estimate };
    travel > T::TWO * widest + deflection_tolerance(tables, estimator, force)
}

/// Tolerance of a change of the deflection beside gap and wind-up [m].
pub fn deflection_tolerance<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    estimator: &ParameterEstimator<T, P>,
    force: T,
) -> T {
    let count = tables.counts.output.angle * tables.levers.output;
    count + T::TWO * (tables.supervisor.margin + estimator.uncertainty.compliance_uncertainty * force.abs())
}

/// Returns true if a deflection of the teeth [m] lies between the flanks or beyond a flank by at most the wind-up of a
/// force [N].
pub fn is_possible<T: Real, const P: usize>(estimator: &ParameterEstimator<T, P>, deflection: T, force: T) -> bool {
    classify_deflection(estimator, deflection, force) == DeflectionRange::Possible
}

/// Returns true if a deflection of the teeth [m] lies in its range, or beyond it by no more than wear or wind-up.
pub fn is_within_wear<T: Real, const P: usize>(estimator: &ParameterEstimator<T, P>, deflection: T) -> bool {
    classify_deflection(estimator, deflection, T::ZERO) != DeflectionRange::Impossible
}

/// Range of a deflection beyond the flanks.
#[cold]
fn classify_deflection<T: Real, const P: usize>(
    estimator: &ParameterEstimator<T, P>,
    deflection: T,
    force: T,
) -> DeflectionRange {
    let [half_gap, compliance] = estimator.half_gap_and_compliance();
    let (beyond, force) = if deflection > T::ZERO { (deflection, force) } else { (-deflection, -force) };
    let wind_up = if force > T::ZERO { compliance * force } else { T::ZERO };
    let beyond = beyond - wind_up - estimator.uncertainty.reach;
    if beyond < T::ZERO {
        DeflectionRange::Possible
    } else if beyond < half_gap {
        DeflectionRange::Worn
    } else {
        DeflectionRange::Impossible
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::identification::regressors::COMPLIANCE;
    use crate::observer::sensors::latency::SampleAge;
    use crate::observer::test_tables::{Q1, Q1_DOUBLE, estimator, observer};

    #[test]
    fn speed_is_kept_over_five_lost_readings() {
        let tables = observer();
        let period = tables.clock.period;
        let rate_after = |periods: u32| {
            let mut detector = OutputFaultDetector::default();
            let mut read = |counts: i32, output_interval: u32| {
                let readings = SensorReadings {
                    command: 0.0,
                    motor: CountChange::By(0),
                    motor_travel: 0.0,
                    motor_interval: period,
                    motor_age: 0,
                    motor_sample_age: SampleAge::Fresh,
                    output: Some(CountChange::By(counts)),
                    output_travel: 0.0,
                    output_age: 0,
                    output_interval,
                    torque_known: true,
                    out_of_time: false,
                };
                detector.check_reading(&tables, &readings, true);
                detector.rate()
            };
            (0..100).for_each(|_| _ = read(5, period));
            read(5 * periods as i32, periods * period)
        };
        assert!(rate_after(6) > 0);
        assert_eq!(rate_after(7), 0);
    }

    /// Measurement of teeth in the middle of the gap, but for a deflection [m].
    fn deflected(deflection: f32) -> MeshMeasurement<f32> {
        MeshMeasurement {
            flank_shift: 0.0,
            raw_deflection: 0.0,
            deflection,
            rate: 0.0,
            travel: 0.0,
            motor_force: 0.0,
            direction: 0.0,
            force: 0.0,
        }
    }

    #[test]
    fn impossible_deflection_for_4_ms_is_fault() {
        let (tables, mut detector) = (&Q1, OutputFaultDetector::default());
        let estimator = estimator(tables);
        // 10 mm: no teeth deflect that far. Periods of 0.1 ms.
        let mut judge = || detector.check_deflection(tables, &deflected(10e-3), &estimator, 10e-3, true);
        (0..39).for_each(|_| assert_eq!(judge(), None));
        assert_eq!(judge(), Some(OutputFault::OutOfRange));
    }

    #[test]
    fn output_is_silent_after_10_ms() {
        let (tables, mut detector) = (&Q1, OutputFaultDetector { silent_periods: 100, ..Default::default() });
        let estimator = estimator(tables);
        let judge = |detector: &mut OutputFaultDetector<f32>| {
            detector.check_deflection(tables, &deflected(0.0), &estimator, 0.0, true)
        };
        assert_eq!(judge(&mut detector), None);
        detector.silent_periods += 1;
        assert_eq!(judge(&mut detector), Some(OutputFault::Silent));
    }

    #[test]
    fn margin_is_a_tenth_of_gap_and_wind_up() {
        let tables = &Q1_DOUBLE;
        let (compliance, force) = (tables.learner.mean[COMPLIANCE], 2.5 * tables.levers.per_sun);
        // Half-gap of 80 um, and motor of 2.5 N m.
        let tenth = 0.1 * (80e-6 + compliance * force);
        assert!((tables.supervisor.margin / tenth - 1.0).abs() < 1e-9, "{}", tables.supervisor.margin);
    }
}

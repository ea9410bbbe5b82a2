//! Faults of the motor encoder (O22), in the order of the checks, and its readmission:
//!
//! | # | found by | condition | purpose | needed by |
//! |---|---|---|---|---|
//! | 1 | counts that jumped ([`CountChange::Jumped`]) | four readings farther apart than any motor turns | random counts, a slipped coupling | `wild motor_encoder::random_motor_counts_are_reported` |
//! | 2 | [`Plausibility`]: counts that jump | a few readings farther on than motor and link can throw the motor | small jumps | `wild motor_encoder::small_motor_jump_is_reported` |
//! | 3 | [`Plausibility`]: counts that stand still at once | fewer counts than torque and teeth explain | a frozen encoder in motion, within a few periods | `wild motor_encoder::motor_freeze_at_speed_is_detected` |
//! | 4 | the output outruns counts that stand still under a torque | more than wind-up, while a free motor would have moved | a frozen encoder in slow motion | `wild motor_encoder::slow_motor_freeze_is_detected_in_the_gap` |
//! | 5 | the output outruns counts that stand still | more than gap and wind-up, while the counts stand still for 1 ms | a frozen encoder in slow motion without torque | `wild motor_encoder::link_travel_reveals_frozen_motor` |
//!
//! After an exclusion no reading of the motor is used and no estimate is valid. The encoder is readmitted once its
//! readings have been plausible for 20 ms, move, and agree with the output encoder, or after 100 ms at rest. Readings
//! that move plausibly for 100 ms without agreement mean that the encoder has slipped: the encoder is readmitted and
//! the offset is estimated anew.

use super::output_faults::{deflection_tolerance, exceeds_gap};
use super::plausibility::{MotionLimits, Plausibility, PlausibilityResult, counts};
use super::thresholds::{MOTOR_FAULT, PARTS_PER_COUNT, PLAUSIBILITY};
use crate::estimates::MotorFault;
use crate::numbers::Real;
use crate::numbers::arithmetic::deadband;
use crate::numbers::state_words::state_words;
use crate::observer::filters::drive_side::DriveSide;
use crate::observer::identification::ParameterEstimator;
use crate::observer::sensors::SensorReadings;
use crate::observer::sensors::counts::CountChange;
use crate::observer::sensors::latency::SampleAge;
use crate::observer::tables::{ObserverTables, StopTable, SupervisorTable};

/// Fault checks of the motor encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct MotorFaultDetector<T: Real> {
    plausibility: Plausibility,
    /// Reason for the exclusion.
    fault: Option<MotorFault>,
    /// Periods since the counts last changed.
    standstill_periods: u16,
    /// Speed [counts per period] and travel [counts] that the torque alone would have given a free motor since then.
    free_speed: T,
    free_travel: T,
    /// Deflection less wind-up [m] and mesh force [N] when the counts last changed.
    standstill_deflection: T,
    standstill_force: T,
    /// Periods of plausible readings since the exclusion, and whether the counts have moved.
    plausible_for: u16,
    has_moved: bool,
}
state_words! {
    struct MotorFaultDetector<T> {
        plausibility, fault, standstill_periods, free_speed, free_travel, standstill_deflection, standstill_force,
        plausible_for, has_moved,
    }
}

/// Result of screening a motor reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorReadingStatus {
    /// The reading is used.
    Accepted,
    /// The reading is rejected unless the next readings confirm it; the motor is assumed to keep its speed.
    Rejected,
    /// The reading excludes the encoder.
    Excluded,
    /// The encoder was excluded before.
    Recovering(RecoveryState),
}

/// State of the readings of an excluded encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecoveryState {
    /// The readings are not plausible yet.
    NotPlausible,
    /// The readings are plausible: the encoder is readmitted if it agrees with the output encoder.
    Plausible,
    /// The readings have been plausible for so long that the encoder is readmitted in any case; without agreement it
    /// has slipped.
    LongPlausible,
}

/// Influences that change the motor's speed between two readings.
pub struct MotorMotionLimits<'now, T: Real> {
    pub table: &'now SupervisorTable<T>,
    pub drive: &'now DriveSide<T>,
    /// Largest unknown braking torque beside the commanded torque [N m].
    pub unknown_torque: T,
    /// Speed of the link [parts of an output count per period]; `None` if unknown.
    pub link_rate: Option<i32>,
}

impl<T: Real> MotionLimits<T> for MotorMotionLimits<'_, T> {
    fn stop_table(&self) -> &StopTable<T> {
        &self.table.motor
    }

    fn half_deceleration(&self) -> T {
        self.table.motor_brake * (self.drive.peak_torque() + self.unknown_torque)
    }

    /// Teeth throw the motor back at its own speed, or to twice the link's speed; the torque also changes the speed
    /// before the estimate follows.
    fn impact_speed_change(&self, rate: i32) -> i32 {
        let Some(link) = self.link() else { return i32::MAX };
        let fastest = rate.saturating_abs().max(link.saturating_abs());
        fastest
            .saturating_mul(2)
            .saturating_add(saturating_whole(T::from_i32(PARTS_PER_COUNT) * self.unobserved_speed_change()))
    }

    /// Teeth move the motor no farther from the link's speed than it was.
    fn speed_kept_by_teeth(&self, rate: i32) -> i32 {
        let Some(link) = self.link() else { return 0 };
        link.saturating_abs().saturating_sub(rate.saturating_sub(link).saturating_abs()).max(0)
    }

    /// The estimated speed lags behind by a few periods of braking. Speeds below a count per period are not certain.
    fn lower_speed_bound(&self, rate: i32) -> T {
        let braked = counts::<T>(rate) - self.unobserved_speed_change();
        if rate >= PARTS_PER_COUNT && braked > T::ZERO { braked } else { T::ZERO }
    }
}

impl<T: Real> MotorMotionLimits<'_, T> {
    /// Speed of a motor that turns with the link [parts of a motor count per period].
    fn link(&self) -> Option<i32> {
        self.link_rate.map(|rate| saturating_whole(T::from_i32(rate) * self.table.motor_counts))
    }

    /// Change of speed that the torques may have caused and the estimate does not show yet [counts per period].
    fn unobserved_speed_change(&self) -> T {
        T::from_i32(2 * MOTOR_FAULT.speed_lag) * self.half_deceleration()
    }
}

/// Truncates towards zero and saturates.
fn saturating_whole<T: Real>(size: T) -> i32 {
    size.to_i64().clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

impl<T: Real> MotorFaultDetector<T> {
    /// Reason for the exclusion of the encoder.
    pub fn fault(&self) -> Option<MotorFault> {
        self.fault
    }

    /// Excludes the encoder.
    pub fn exclude(&mut self, fault: MotorFault) -> MotorReadingStatus {
        self.fault = Some(fault);
        self.plausibility.reset_speed();
        self.plausible_for = 0;
        self.has_moved = fault == MotorFault::Jumped;
        MotorReadingStatus::Excluded
    }

    /// Readmits the encoder.
    pub fn readmit(&mut self) {
        *self = Self { plausibility: self.plausibility, ..Self::default() };
    }

    /// Speed of the motor, 0 if unknown [counts per period].
    pub fn speed_in_counts(&self) -> T {
        self.plausibility.speed().unwrap_or(T::ZERO)
    }

    /// Returns true once the counts have stood still for longer than chance explains.
    pub fn is_at_standstill(&self, table: &SupervisorTable<T>) -> bool {
        self.standstill_periods >= table.motor_unmoved_after
    }

    /// Judges the reading of one period by the readings before.
    #[inline(always)]
    pub fn check_reading(
        &mut self,
        tables: &ObserverTables<T>,
        readings: &SensorReadings<T>,
        limits: &MotorMotionLimits<'_, T>,
    ) -> MotorReadingStatus {
        let clock = &tables.clock;
        let is_regular = readings.motor_interval.wrapping_sub(clock.shortest) <= clock.longer;
        let is_used = self.fault.is_none() && readings.motor_sample_age != SampleAge::Unusable;
        let CountChange::By(by) = readings.motor else { return self.check_distant_reading(readings) };
        if !(is_regular && is_used) {
            return self.check_irregular_reading(tables, readings, limits, is_regular, by);
        }
        if by == 0 {
            self.integrate_free_motion(&tables.supervisor, limits.drive);
        } else {
            self.standstill_periods = 0;
        }
        match self.plausibility.check(limits, by) {
            PlausibilityResult::Plausible => MotorReadingStatus::Accepted,
            PlausibilityResult::Suspect => MotorReadingStatus::Rejected,
            PlausibilityResult::Implausible => self.exclude_implausible(),
        }
    }

    /// Counts one more period at a standstill and integrates the travel that the torque would have given a motor held
    /// by friction alone.
    fn integrate_free_motion(&mut self, table: &SupervisorTable<T>, drive: &DriveSide<T>) {
        if self.standstill_periods == 0 {
            (self.free_speed, self.free_travel) = (T::ZERO, T::ZERO);
        }
        self.standstill_periods = self.standstill_periods.saturating_add(1);
        let torque = drive.air_gap();
        let per_torque = T::TWO * table.motor_brake;
        let excess_torque = deadband(torque, table.motor_drag);
        if excess_torque == T::ZERO {
            // Friction in excess of the torque stops the motor without reversing it.
            self.free_speed = deadband(self.free_speed, per_torque * (table.motor_drag - torque.abs()));
        } else {
            self.free_speed += per_torque * excess_torque;
        }
        self.free_travel += self.free_speed;
    }

    /// Handles the first reading, and a reading far from the last one.
    #[cold]
    fn check_distant_reading(&mut self, readings: &SensorReadings<T>) -> MotorReadingStatus {
        let has_jumped = matches!(readings.motor, CountChange::Jumped(_));
        self.plausible_for = 0;
        self.has_moved |= has_jumped;
        if has_jumped {
            self.plausibility.reset_speed();
        }
        if self.fault.is_some() {
            MotorReadingStatus::Recovering(RecoveryState::NotPlausible)
        } else if readings.motor_sample_age == SampleAge::Unusable {
            self.exclude(MotorFault::Silent)
        } else if has_jumped {
            self.exclude(MotorFault::Jumped)
        } else if readings.motor == CountChange::First {
            MotorReadingStatus::Accepted
        } else {
            MotorReadingStatus::Rejected
        }
    }

    /// Handles a reading after an irregular interval, a reading that is too old, and a reading of an excluded encoder.
    #[cold]
    fn check_irregular_reading(
        &mut self,
        tables: &ObserverTables<T>,
        readings: &SensorReadings<T>,
        limits: &MotorMotionLimits<'_, T>,
        is_regular: bool,
        by: i32,
    ) -> MotorReadingStatus {
        let mut is_plausible = readings.motor_sample_age != SampleAge::Unusable;
        if is_regular {
            let result = self.plausibility.check(limits, by);
            is_plausible &= result == PlausibilityResult::Plausible;
            if result == PlausibilityResult::Implausible {
                self.plausibility.reset_speed();
            }
        } else if readings.motor_interval > 0 {
            // The motor may have moved any way during missing readings.
            self.plausibility.reset_speed();
        }
        if self.fault.is_none() {
            return if readings.motor_sample_age == SampleAge::Unusable {
                self.exclude(MotorFault::Silent)
            } else {
                MotorReadingStatus::Accepted
            };
        }
        self.has_moved |= by != 0;
        self.plausible_for = if is_plausible { self.plausible_for.saturating_add(1) } else { 0 };
        let table = &tables.supervisor;
        MotorReadingStatus::Recovering(if self.plausible_for >= table.motor_slipped_after {
            RecoveryState::LongPlausible
        } else if self.plausible_for >= table.motor_trusted_after && self.has_moved {
            RecoveryState::Plausible
        } else {
            RecoveryState::NotPlausible
        })
    }

    /// Excludes the encoder after readings that no motor can follow.
    #[cold]
    fn exclude_implausible(&mut self) -> MotorReadingStatus {
        let is_frozen = self.plausibility.is_standstill();
        self.exclude(if is_frozen { MotorFault::Frozen } else { MotorFault::Jumped })
    }

    /// Returns true if the link has moved by more than gap and wind-up allow while the motor's counts stood still:
    /// teeth would have moved the motor. `unwound_deflection` is the deflection less wind-up [m], under a force [N].
    pub fn is_outrun_by_output<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        estimator: &ParameterEstimator<T, P>,
        unwound_deflection: T,
        force: T,
    ) -> bool {
        if self.standstill_periods == 0 {
            (self.standstill_deflection, self.standstill_force) = (unwound_deflection, force);
            return false;
        }
        let [half_gap, compliance] = estimator.half_gap_and_compliance();
        let output_travel = (unwound_deflection - self.standstill_deflection).abs();
        // A motor that no torque moves is held by teeth: the link can move by the wind-up of those teeth, and by a
        // little more while the half-gap is a guess.
        if self.standstill_periods > PLAUSIBILITY.min_standstill_readings
            && self.free_travel.abs() > T::from_i32(MOTOR_FAULT.blocked_free_travel)
        {
            let wind_up = compliance * (force - self.standstill_force).abs();
            let half_gap_tolerance = T::QUARTER * estimator.uncertainty.guessed_half_gap;
            return output_travel > half_gap_tolerance + wind_up + deflection_tolerance(tables, estimator, force);
        }
        output_travel > half_gap
            && self.is_at_standstill(&tables.supervisor)
            && exceeds_gap(tables, estimator, output_travel, force)
    }

    /// Returns true if the readings have moved. Without agreement a moving encoder has slipped; a stationary one may
    /// still be frozen.
    pub fn has_moved(&self) -> bool {
        self.has_moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::{Q1, current, drive, estimator, observer, supervisor};

    /// Motor side under an air-gap torque [N m].
    fn under(torque: f32) -> DriveSide<f32> {
        let mut side = DriveSide::default();
        side.predict(&drive(), &current(), torque, 0.0);
        side
    }

    /// Free travel after ten periods at a standstill under a torque.
    fn free_travel(torque: f32) -> f32 {
        let mut detector = MotorFaultDetector::default();
        (0..10).for_each(|_| detector.integrate_free_motion(&supervisor(), &under(torque)));
        detector.free_travel
    }

    #[test]
    fn torque_within_friction_moves_nothing() {
        assert_eq!(free_travel(0.1), 0.0);
        assert_eq!(free_travel(-0.1), 0.0);
    }

    #[test]
    fn torque_above_friction_moves_free_motor() {
        // 1 count per period^2 and newton metre above 0.1 N m, for 1 + 2 + ... + 10 periods.
        assert!((free_travel(1.1) - 55.0).abs() < 1e-3, "{}", free_travel(1.1));
        assert!((free_travel(-1.1) + 55.0).abs() < 1e-3);
    }

    #[test]
    fn friction_stops_free_motor() {
        let mut detector = MotorFaultDetector::default();
        detector.integrate_free_motion(&supervisor(), &under(1.1));
        assert_eq!(detector.free_speed, 1.0);
        (0..20).for_each(|_| detector.integrate_free_motion(&supervisor(), &under(0.0)));
        assert_eq!(detector.free_speed, 0.0);
    }

    #[test]
    fn standstill_counts_from_limit() {
        let (mut detector, table) = (MotorFaultDetector::<f32>::default(), supervisor());
        for _ in 1..table.motor_unmoved_after {
            detector.integrate_free_motion(&table, &under(0.0));
        }
        assert!(!detector.is_at_standstill(&table));
        detector.integrate_free_motion(&table, &under(0.0));
        assert!(detector.is_at_standstill(&table));
    }

    #[test]
    fn readmission_clears_fault() {
        let mut detector = MotorFaultDetector::<f32>::default();
        assert_eq!(detector.exclude(MotorFault::Jumped), MotorReadingStatus::Excluded);
        assert_eq!((detector.fault(), detector.has_moved()), (Some(MotorFault::Jumped), true));
        detector.readmit();
        assert_eq!((detector.fault(), detector.has_moved()), (None, false));
    }

    #[test]
    fn unknown_link_speed_allows_any_impact() {
        let (side, table) = (under(0.0), supervisor());
        let limits = MotorMotionLimits { table: &table, drive: &side, unknown_torque: 0.0, link_rate: None };
        assert_eq!((limits.impact_speed_change(640), limits.speed_kept_by_teeth(640)), (i32::MAX, 0));
    }

    #[test]
    fn impact_reaches_twice_the_faster_speed() {
        let (side, table) = (under(0.0), supervisor());
        let limits =
            |rate| MotorMotionLimits { table: &table, drive: &side, unknown_torque: 0.0, link_rate: Some(rate) };
        assert_eq!(limits(100).impact_speed_change(-640), 1280);
        assert_eq!(limits(-1000).impact_speed_change(640), 2000);
        assert_eq!(limits(100).speed_kept_by_teeth(100), 100, "a motor that turns with the link keeps its speed");
        assert_eq!(limits(100).speed_kept_by_teeth(300), 0);
    }

    #[test]
    fn speed_below_one_count_is_uncertain() {
        let (side, table) = (under(0.0), supervisor());
        let limits = MotorMotionLimits { table: &table, drive: &side, unknown_torque: 0.0, link_rate: None };
        assert_eq!(limits.lower_speed_bound(PARTS_PER_COUNT - 1), 0.0);
        assert_eq!(limits.lower_speed_bound(PARTS_PER_COUNT), 1.0);
        let braked = MotorMotionLimits { unknown_torque: 1.0, ..limits };
        assert_eq!(braked.lower_speed_bound(PARTS_PER_COUNT), 0.0, "braking by 1 N m is not in the estimate yet");
    }

    #[test]
    fn braking_for_six_periods_is_not_seen() {
        let (side, table) = (under(0.0), supervisor());
        let braked = MotorMotionLimits { table: &table, drive: &side, unknown_torque: 1.0, link_rate: Some(0) };
        // 1 N m takes 1 count per period from the speed in each period.
        assert_eq!(braked.lower_speed_bound(10 * PARTS_PER_COUNT), 4.0);
        assert_eq!(braked.impact_speed_change(0), 6 * PARTS_PER_COUNT);
    }

    #[test]
    fn motor_held_for_16_counts_is_blocked() {
        let tables = observer();
        let is_outrun = |periods: u16| {
            let mut detector = MotorFaultDetector::default();
            (0..periods).for_each(|_| detector.integrate_free_motion(&tables.supervisor, &under(1.1)));
            detector.is_outrun_by_output(&tables, &estimator(&tables), 1e-3, 0.0)
        };
        // 1.1 N m would have moved a free motor by 1 + ... + 5 = 15 counts, and by 21 counts a period later.
        assert!(!is_outrun(5) && is_outrun(6));
    }

    /// Fresh reading of Q1's motor after a period in which its counts moved.
    fn reading(by: i32) -> SensorReadings<f32> {
        SensorReadings {
            command: 0.0,
            motor: CountChange::By(by),
            motor_travel: 0.0,
            motor_interval: Q1.clock.period,
            motor_age: 0,
            motor_sample_age: SampleAge::Fresh,
            output: None,
            output_travel: 0.0,
            output_age: 0,
            output_interval: 0,
            torque_known: true,
            out_of_time: false,
        }
    }

    /// First reading of an excluded encoder with a state, if its counts move by `by` in each period of 0.1 ms.
    fn readings_until(state: RecoveryState, by: i32) -> Option<u32> {
        let (side, mut detector) = (under(0.0), MotorFaultDetector::default());
        let table = &Q1.supervisor;
        let limits = MotorMotionLimits { table, drive: &side, unknown_torque: 0.0, link_rate: None };
        detector.exclude(MotorFault::Frozen);
        (1..2000).find(|_| {
            let status = detector.check_reading(&Q1, &reading(by), &limits);
            status == MotorReadingStatus::Recovering(state)
        })
    }

    #[test]
    fn plausible_for_20_ms_may_be_readmitted() {
        assert_eq!(readings_until(RecoveryState::Plausible, 1), Some(200));
        assert_eq!(readings_until(RecoveryState::Plausible, 0), None, "counts that stand still may be frozen");
    }

    #[test]
    fn plausible_for_100_ms_is_readmitted() {
        assert_eq!([1, 0].map(|by| readings_until(RecoveryState::LongPlausible, by)), [Some(1000); 2]);
    }

    #[test]
    fn unmoved_for_1_ms_is_standstill() {
        let (mut detector, table) = (MotorFaultDetector::<f32>::default(), &Q1.supervisor);
        (0..9).for_each(|_| detector.integrate_free_motion(table, &under(0.0)));
        assert!(!detector.is_at_standstill(table));
        detector.integrate_free_motion(table, &under(0.0));
        assert!(detector.is_at_standstill(table));
    }

    #[test]
    fn standstill_keeps_speed_for_3_ms() {
        let (side, mut detector) = (under(0.0), MotorFaultDetector::default());
        let table = &Q1.supervisor;
        let limits = MotorMotionLimits { table, drive: &side, unknown_torque: 0.0, link_rate: None };
        let mut read = |by: i32| {
            detector.check_reading(&Q1, &reading(by), &limits);
            detector.speed_in_counts()
        };
        // Half a count per period.
        (0..200).for_each(|period| _ = read(period % 2));
        let last = (0..30).map(|_| read(0)).last();
        assert!(last > Some(0.0));
        assert_eq!(read(0), 0.0);
    }
}

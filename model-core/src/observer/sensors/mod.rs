//! Sensors: convert the raw samples of a control period to counts exact over any number of turns (O1), ages and
//! notices. No filtering.

pub mod counts;
pub mod latency;

pub(super) mod thresholds;

use counts::{CountChange, Counts};
use latency::{Latency, SampleAge};

use crate::estimates::Notices;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::samples::{Reading, Samples};
use crate::observer::tables::{ClockTable, ObserverTables};

/// Counts of both encoders, time of the last samples, and latency of the motor readings.
#[derive(Debug, Clone)]
pub struct Sensors {
    pub counts: Counts,
    pub latency: Latency,
    /// Time of the last samples [ticks].
    time: u32,
    /// Periods for which a rejected torque sample may still affect the filters.
    torque_unknown_for: u16,
}
state_words! { struct Sensors { counts, latency, time, torque_unknown_for } }

/// Evaluated samples of one period.
#[derive(Debug, Clone, Copy)]
pub struct SensorReadings<T: Real> {
    /// Commanded torque; zero if the sample was rejected [N m].
    pub command: T,
    /// Result of the motor reading.
    pub motor: CountChange,
    /// Travel of the motor counts [rad].
    pub motor_travel: T,
    /// Time from the previous motor reading to this reading; 0 for a repeated reading [ticks].
    pub motor_interval: u32,
    /// Age of the motor reading [ticks].
    pub motor_age: u32,
    /// Freshness of the motor reading.
    pub motor_sample_age: SampleAge,
    /// Result of the output reading; `None` without a fresh reading.
    pub output: Option<CountChange>,
    /// Travel of the output counts in use, measured or implied [rad].
    pub output_travel: T,
    /// Age of the output reading [ticks].
    pub output_age: u32,
    /// Time from the previous fresh output reading to this fresh reading [ticks].
    pub output_interval: u32,
    /// The torque sample was within twice the motor's limit.
    pub torque_known: bool,
    /// The period was too short or too long, or time ran backwards.
    pub out_of_time: bool,
}

impl Sensors {
    /// Builds sensors without any reading.
    pub fn new(has_output: bool) -> Self {
        let mut counts = Counts::default();
        if !has_output {
            counts.imply_output();
        }
        Self { counts, latency: Latency::default(), time: 0, torque_unknown_for: 0 }
    }

    /// Returns whether a rejected torque sample may still affect the filters.
    pub fn is_torque_uncertain(&self) -> bool {
        self.torque_unknown_for > 0
    }

    /// Evaluates the samples of one period.
    #[inline(always)]
    pub fn step<T: Real>(&mut self, tables: &ObserverTables<T>, samples: &Samples<T>) -> SensorReadings<T> {
        // False for NaN, too.
        let torque_known = samples.torque.abs() <= tables.current.believed;
        self.torque_unknown_for =
            if torque_known { self.torque_unknown_for.saturating_sub(1) } else { tables.current.unsure_for };
        let command = if torque_known { samples.torque } else { T::ZERO };
        let clock = &tables.clock;
        let motor_age = age(samples.time, &samples.motor);
        let motor_sample_age = self.latency.step((motor_age <= clock.oldest).then_some(motor_age), clock.period);
        let output_age = samples.output.map_or(0, |reading| age(samples.time, &reading));
        let output = samples.output.filter(|_| output_age <= clock.oldest);
        let counted = self.counts.read_counts(&tables.counts, samples.motor, output);
        let before = core::mem::replace(&mut self.time, samples.time);
        let elapsed =
            if counted.motor == CountChange::First { clock.shortest } else { samples.time.wrapping_sub(before) };
        let out_of_time = elapsed.wrapping_sub(clock.shortest) > clock.longer;
        let motor_counts = if let CountChange::By(by) = counted.motor { by } else { 0 };
        SensorReadings {
            command,
            motor: counted.motor,
            motor_travel: tables.counts.motor.angle * T::from_i32(motor_counts),
            motor_interval: counted.motor_interval,
            motor_age,
            motor_sample_age,
            output: counted.output,
            output_travel: tables.counts.output.angle * T::from_i32(counted.output_travel),
            output_age,
            output_interval: counted.output_interval,
            torque_known,
            out_of_time,
        }
    }
}

impl<T: Real> SensorReadings<T> {
    /// Returns the defects of the samples.
    #[inline(always)]
    pub fn notices(&self) -> Notices {
        if self.torque_known && !self.out_of_time && matches!(self.motor, CountChange::By(_)) {
            return Notices::default();
        }
        Notices {
            torque_unknown: !self.torque_known,
            out_of_time: self.out_of_time,
            motor_implausible: self.motor == CountChange::Implausible,
            motor_jumped: matches!(self.motor, CountChange::Jumped(_)),
        }
    }
}

/// Age of a reading [ticks]; zero for a time stamp in the future.
fn age(now: u32, reading: &Reading) -> u32 {
    (now.wrapping_sub(reading.time) as i32).max(0).unsigned_abs()
}

/// Converts ticks to seconds.
pub fn seconds<T: Real>(table: &ClockTable<T>, ticks: u32) -> T {
    T::from_i32(ticks as i32) * table.tick
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::{Q1, observer};

    #[test]
    fn reading_is_lost_after_ten_periods() {
        let tables = observer();
        let sample_age = |periods: u32| {
            let time = 100 * tables.clock.period;
            let motor = Reading { counts: 0, time: time - periods * tables.clock.period };
            let samples = Samples { time, motor, ..Samples::default() };
            Sensors::new(true).step(&tables, &samples).motor_sample_age
        };
        assert_ne!(sample_age(10), SampleAge::Unusable);
        assert_eq!(sample_age(11), SampleAge::Unusable);
    }

    /// Results of samples of Q1 with torques [N m], one per period.
    fn with_torques<const N: usize>(sensors: &mut Sensors, torques: [f32; N]) -> [bool; N] {
        torques.map(|torque| sensors.step(&Q1, &Samples { torque, ..Samples::default() }).torque_known)
    }

    #[test]
    fn torque_above_twice_the_limit_is_rejected() {
        // Q1's motor has 2.5 N m.
        let known = with_torques(&mut Sensors::new(true), [4.9, 5.1, -4.9, -5.1]);
        assert_eq!(known, [true, false, true, false]);
    }

    #[test]
    fn rejected_torque_is_uncertain_for_20_ms() {
        let mut sensors = Sensors::new(true);
        with_torques(&mut sensors, [100.0]);
        with_torques(&mut sensors, [0.0; 199]);
        assert!(sensors.is_torque_uncertain());
        with_torques(&mut sensors, [0.0]);
        assert!(!sensors.is_torque_uncertain());
    }
}

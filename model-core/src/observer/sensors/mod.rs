//! The sensors: raw samples of one control period become counts that are exact over any number of turns, ages, and what
//! was wrong with them. Nothing is filtered here.

pub mod counts;
pub mod latency;

use counts::{Advance, Counts};
use latency::{Freshness, Latency};

use crate::numbers::Real;
use crate::observer::estimates::Notices;
use crate::observer::samples::{Reading, Samples};
use crate::observer::tables::{ClockTable, ObserverTables};

/// Both encoders, the clock of their readings, and how late the motor's come.
#[derive(Debug, Clone)]
pub struct Sensors {
    pub counts: Counts,
    pub latency: Latency,
    /// When the last samples were taken [ticks].
    time: u32,
    /// Periods for which a torque that was none may still be felt in the filters.
    unsure_for: u16,
}

/// What the samples of one period came to.
#[derive(Debug, Clone, Copy)]
pub struct Sensed<T: Real> {
    /// Torque that was commanded; zero where it was none [N m].
    pub command: T,
    /// What the motor's reading came to.
    pub motor: Advance,
    /// Angle by which the motor's counts moved [rad].
    pub motor_turned: T,
    /// Time between the motor's reading and the one before; 0 if it is the same again [ticks].
    pub motor_interval: u32,
    /// Age of the motor's reading [ticks].
    pub motor_age: u32,
    /// How fresh it is.
    pub freshness: Freshness,
    /// What the output's reading came to; `None` when there was no fresh one.
    pub output: Option<Advance>,
    /// Angle by which the output moved that is in use [rad].
    pub output_turned: T,
    /// Age of the output's reading [ticks].
    pub output_age: u32,
    /// Time between that reading and the fresh one before [ticks].
    pub output_interval: u32,
    /// The torque was one that the motor can give.
    pub torque_known: bool,
    /// The period was too short or too long, or time went backwards.
    pub out_of_time: bool,
}

impl Sensors {
    /// Sensors that have seen nothing yet.
    pub fn new(has_output: bool) -> Self {
        let mut counts = Counts::default();
        if !has_output {
            counts.imply();
        }
        Self { counts, latency: Latency::default(), time: 0, unsure_for: 0 }
    }

    /// Whether a torque that was none may still be felt in the filters.
    pub fn is_unsure(&self) -> bool {
        self.unsure_for > 0
    }

    /// Takes the samples of one period.
    #[inline(always)]
    pub fn step<T: Real>(&mut self, tables: &ObserverTables<T>, samples: &Samples<T>) -> Sensed<T> {
        // False for what is not a number, too.
        let known = samples.torque.abs() <= tables.current.believed;
        self.unsure_for = if known { self.unsure_for.saturating_sub(1) } else { tables.current.unsure_for };
        let command = if known { samples.torque } else { T::ZERO };
        let clock = &tables.clock;
        let motor_age = age(samples.time, &samples.motor);
        let freshness = self.latency.step((motor_age <= clock.oldest).then_some(motor_age), clock.period);
        let output_age = samples.output.map_or(0, |reading| age(samples.time, &reading));
        let output = samples.output.filter(|_| output_age <= clock.oldest);
        let taken = self.counts.take(&tables.counts, samples.motor, output);
        let before = core::mem::replace(&mut self.time, samples.time);
        let lasted = if taken.motor == Advance::Began { clock.shortest } else { samples.time.wrapping_sub(before) };
        let out_of_time = lasted.wrapping_sub(clock.shortest) > clock.longer;
        let motor_by = if let Advance::By(by) = taken.motor { by } else { 0 };
        Sensed {
            command,
            motor: taken.motor,
            motor_turned: tables.counts.motor.angle * T::from_i32(motor_by),
            motor_interval: taken.motor_apart,
            motor_age,
            freshness,
            output: taken.output,
            output_turned: tables.counts.output.angle * T::from_i32(taken.turned),
            output_age,
            output_interval: taken.apart,
            torque_known: known,
            out_of_time,
        }
    }
}

impl<T: Real> Sensed<T> {
    /// What was wrong with the samples.
    #[inline(always)]
    pub fn notices(&self) -> Notices {
        if self.torque_known && !self.out_of_time && matches!(self.motor, Advance::By(_)) {
            return Notices::default();
        }
        Notices {
            torque_unknown: !self.torque_known,
            out_of_time: self.out_of_time,
            motor_implausible: self.motor == Advance::Implausible,
            motor_jumped: matches!(self.motor, Advance::Jumped(_)),
        }
    }
}

/// Age of a reading [ticks]. One from the future is of now.
fn age(now: u32, reading: &Reading) -> u32 {
    (now.wrapping_sub(reading.time) as i32).max(0).unsigned_abs()
}

/// Ticks as seconds.
pub fn seconds<T: Real>(table: &ClockTable<T>, ticks: u32) -> T {
    T::from_i32(ticks as i32) * table.tick
}

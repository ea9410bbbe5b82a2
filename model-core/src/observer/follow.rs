//! From samples to the two sides: counts, motor side and load side go on by one control period, and with them the places
//! of encoders and gears. What follows of both together is left to `present`.

use super::counts::{Advance, Taken};
use super::estimates::Notices;
use super::late::Heard;
use super::pace::Verdict;
use super::regressors::{self, Regressors};
use super::samples::{Reading, Samples};
use super::state::Observer;
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;

/// Periods between two readings over which the pace is taken to go on.
const MISSED: u32 = 6;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Takes the samples of one period in; how the motor was heard of.
    pub(super) fn follow(&mut self, samples: &Samples<T>) -> Heard {
        let tables = self.tables;
        let known = samples.torque.is_finite();
        let command = if known { samples.torque } else { T::ZERO };
        let clock = &tables.clock;
        let motor_age = age(samples.time, &samples.motor);
        let heard = self.lateness.hear((motor_age <= clock.oldest).then_some(motor_age), clock.period);
        let output_age = samples.output.map_or(0, |reading| age(samples.time, &reading));
        let output = samples.output.filter(|_| output_age <= clock.oldest);
        let taken = self.counts.take(&tables.counts, samples.motor, output);
        let before = core::mem::replace(&mut self.time, samples.time);
        let lasted = if taken.motor == Advance::Began { clock.shortest } else { samples.time.wrapping_sub(before) };
        let out_of_time = lasted.wrapping_sub(clock.shortest) > clock.longer;
        let motor_by = if let Advance::By(by) = taken.motor { by } else { 0 };
        self.estimates.notices = Notices::default();
        if !known || out_of_time || !matches!(taken.motor, Advance::By(_)) {
            self.estimates.notices = Notices {
                torque_unknown: !known,
                out_of_time,
                motor_doubted: taken.motor == Advance::Doubted,
                motor_jumped: matches!(taken.motor, Advance::Jumped(_)),
            };
        }

        let motor_turned = tables.counts.motor.angle * T::from_i32(motor_by);
        self.drive.predict(&tables.drive, &tables.current, command, motor_turned);
        match taken.motor {
            Advance::By(_) => {
                let age = self.seconds(motor_age);
                match heard {
                    Heard::Now => self.drive.correct(&tables.drive, age),
                    Heard::Late => self.drive.correct_late(&tables.drive, age),
                    Heard::Missed | Heard::Missing | Heard::Not => {}
                }
            }
            Advance::Began => self.drive.ahead = T::ZERO,
            Advance::Jumped(_) => {
                self.drive.ahead = T::ZERO;
                self.learner.reopen();
            }
            Advance::Doubted => {}
        }

        let output_turned = tables.counts.output.angle * T::from_i32(taken.turned);
        self.load.predict(&tables.load, self.from_meshes, output_turned);
        let began = self.supervisor.hear(taken.output);
        if began {
            self.load.ahead = T::ZERO;
        }
        let follows = self.keep_pace(&taken);
        if follows {
            self.load.correct(&tables.load, self.seconds(output_age), self.from_meshes);
        }
        let far = self.places.go_on(motor_turned, output_turned, tables.counts.mesh_periods);
        if far || began || !matches!(taken.motor, Advance::By(_)) {
            self.find_places();
        }
        heard
    }

    /// Gives the output encoder up where no link could follow its readings; whether the last of them is used.
    #[inline]
    fn keep_pace(&mut self, taken: &Taken) -> bool {
        let tables = self.tables;
        let both = self.supervisor.sees_both();
        let Some(Advance::By(by)) = taken.output else {
            if both && matches!(taken.output, Some(Advance::Jumped(_))) {
                self.pace.lose();
                self.fall_behind();
            }
            return false;
        };
        let clock = &tables.clock;
        let beyond = taken.apart.wrapping_sub(clock.shortest);
        if beyond > clock.longer {
            self.pace.miss(by, beyond > clock.period.saturating_mul(MISSED));
            return both;
        }
        match self.pace.take(&tables.supervisor, by) {
            Verdict::Sound => both,
            Verdict::Doubted => false,
            Verdict::Broken => {
                if both {
                    self.fall_behind();
                }
                self.pace.lose();
                false
            }
        }
    }

    /// Finds exactly where the shafts are.
    pub(super) fn find_places(&mut self) {
        let (free, mesh) = self.exact_places();
        self.places.put(&self.learner, &free, mesh);
    }

    /// The same in the middle of an interval: what is learnt from it was there.
    pub(super) fn keep_places(&mut self) {
        let (free, mesh) = self.exact_places();
        self.places.put(&self.learner, &free, mesh);
        self.places.free = free;
        self.places.mesh_then = mesh;
    }

    fn exact_places(&self) -> (Regressors<T, P>, [T; 2]) {
        let table = &self.tables.counts;
        let (output, _) = self.counts.used();
        let both = self.supervisor.sees_both();
        let link_speed = if both { self.load.speed } else { T::ZERO };
        let output_phase = output.phase(&table.output);
        let free = regressors::free(link_speed, self.counts.motor.phase(&table.motor), both.then_some(output_phase));
        let (sine, cosine) = sine_cosine(output_phase.wrapping_mul(table.meshes));
        (free, [sine, cosine])
    }

    /// Ticks as seconds.
    fn seconds(&self, ticks: u32) -> T {
        T::from_i32(ticks as i32) * self.tables.clock.tick
    }
}

/// Age of a reading in ticks. One from the future is of now.
fn age(now: u32, reading: &Reading) -> u32 {
    (now.wrapping_sub(reading.time) as i32).max(0).unsigned_abs()
}

//! The observer without an output encoder: the load is seen through the teeth while they touch and cannot be seen while
//! they do not. Deciding when to do without is left to `supervisor`.
//!
//! In contact the way is the half-gap and the wind-up of the mesh force, which the motor side gives; the load side is
//! corrected towards that. In the open gap it runs on under the load torque that it had, and the variance of the gap
//! coordinate grows with the square of time for the speed and with the fourth power for the torque.

use super::contact::sign;
use super::motion::magnitude;
use super::regressors::{self, touching};
use super::{Now, Observer, Source};
use crate::mesh::ContactState;
use crate::real::Real;

/// Time without contact, in periods.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Blind {
    open_for: u32,
    /// Contact has been seen since the output encoder was given up.
    anchored: bool,
}

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Gives the output encoder up where it cannot be right, and does without it.
    pub(super) fn watch(&mut self, now: &Now<T, P>) {
        let table = &self.tables.supervisor;
        let [half_gap, compliance] = self.shape();
        let reach = T::TWO * self.knowledge.edge_deviation + self.knowledge.edge_deviation + table.margin + half_gap;
        let wind_up = compliance * now.force;
        let upper = reach + if wind_up > T::ZERO { wind_up } else { T::ZERO };
        let lower = -reach + if wind_up < T::ZERO { wind_up } else { T::ZERO };
        if self.supervisor.judge(table, now.way < upper && now.way > lower) {
            self.counts.imply();
            self.load.speed = self.drive.speed * self.tables.levers.per_ratio;
            self.load.torque = self.supervisor.torque_before();
            self.blind = Blind::default();
            // The link is where the teeth allow it to be; where exactly, the next contact shows.
            let side: T = sign(self.estimates.contact);
            let implied = self.now();
            self.load.ahead += (implied.way - side * half_gap).over(self.tables.levers.output);
        }
        if self.supervisor.source() != Source::Both {
            self.feel(now);
        }
    }

    /// Corrects the load side by what contact shows.
    fn feel(&mut self, now: &Now<T, P>) {
        let levers = &self.tables.levers;
        let [half_gap, compliance] = self.shape();
        let side: T = sign(self.estimates.contact);
        if self.estimates.contact != ContactState::Separated {
            let surprise = (now.way - side * half_gap - compliance * now.force) * levers.per_output;
            self.load.correct(&self.tables.load, surprise);
            self.blind = Blind { open_for: 0, anchored: true };
            return;
        }
        self.blind.open_for = self.blind.open_for.saturating_add(1);
        // Beyond an edge there is contact, however light: the link goes with the motor.
        if magnitude(now.way) > half_gap {
            let edge = if now.way > T::ZERO { half_gap } else { -half_gap };
            self.load.ahead += (now.way - edge) * levers.per_output;
            self.load.speed = self.drive.speed * levers.per_ratio;
        }
    }

    /// Variance of the gap coordinate without an output encoder [m^2]; `None` where nothing is known of it.
    pub(super) fn blind_variance(&self) -> Option<T> {
        if !self.blind.anchored {
            return None;
        }
        let load = &self.tables.load;
        let time = self.tables.period * T::from_i32(self.blind.open_for.min(1 << 20) as i32);
        let levers = &self.tables.levers;
        let by_speed = levers.output * levers.output * load.speed_variance * time * time;
        let squared = time * time * load.way_per_torque;
        let [_, torque_variance] = load.variance;
        let [half_gap_variance, ..] = self.knowledge.variances;
        Some(half_gap_variance + by_speed + squared * squared * torque_variance)
    }

    /// Once an interval: takes the output encoder back when it says again what the motor implies.
    pub(super) fn reconsider(&mut self, settled: Option<T>, force: T) {
        let tables = self.tables;
        let agrees = settled.map(|side| {
            let phase = self.counts.motor.phase(&tables.counts.motor);
            let output = self.counts.output.phase(&tables.counts.output);
            let free = regressors::free(self.load.speed, phase, Some(output));
            let measured =
                tables.counts.length * T::from_i64(self.counts.difference) + tables.levers.sun * self.drive.ahead;
            let expected = self.learner.way(&touching(&free, side, force));
            let room = tables.supervisor.margin + T::TWO * self.knowledge.edge_deviation;
            magnitude(measured - expected) < room
        });
        if self.supervisor.reconsider(&tables.supervisor, agrees) {
            self.counts.trust();
            self.load.ahead = T::ZERO;
        }
    }
}

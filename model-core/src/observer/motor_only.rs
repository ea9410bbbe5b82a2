//! The observer without an output encoder: the load is seen through the teeth while they touch and cannot be seen while
//! they do not. Deciding when to do without is left to `supervisor`.
//!
//! In contact the way is the half-gap and the wind-up of the mesh force, which the motor side gives; the load side is
//! corrected towards that. In the open gap it runs on under the load torque that it had, and the variance of the gap
//! coordinate grows with the square of time for the speed and with the fourth power for the torque.

use super::anchor::Anchor;
use super::contact::{sign, with_hysteresis};
use super::estimates::Doubt;
use super::motion::magnitude;
use super::now::{Now, small};
use super::regressors::{self, Touch};
use super::state::{Blind, Observer};
use super::supervisor::{Place, Return};
use crate::numbers::Real;
use parameters::ContactState;

/// Periods by which contact may have gone before the smoothed force says so.
const GONE_BEFORE: i32 = 30;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Gives the output encoder up where it cannot be right, and does without it.
    pub(super) fn watch(&mut self, now: &Now<T>) {
        let table = &self.tables.supervisor;
        let way = now.way - now.shift;
        let [half_gap, compliance] = self.shape();
        let went_on = magnitude(self.supervisor.went_on(way - compliance * now.force));
        let place = if went_on > half_gap && self.outruns(went_on, now.force) {
            Place::Impossible
        } else if magnitude(way) < self.knowledge.reach {
            Place::Possible
        } else {
            self.far_place(way, now.force)
        };
        if self.supervisor.judge(table, way, place) {
            self.do_without();
        }
        if !self.supervisor.sees_both() {
            self.feel(now);
        }
    }

    /// The output encoder says that the teeth have grown: it is what fails.
    pub(super) fn disbelieve(&mut self) {
        self.supervisor.give_up(Doubt::OutOfRange);
        self.do_without();
    }

    /// The output encoder's readings are no link's: it is where it was going at the pace of those before, if that is known.
    #[cold]
    pub(super) fn fall_behind(&mut self) {
        let pace = self.pace.rate::<T>();
        let frozen = pace.is_some() && self.pace.stands_still();
        self.supervisor.give_up(if frozen { Doubt::Frozen } else { Doubt::OutOfRange });
        self.do_without();
        if let Some(pace) = pace {
            let count = self.tables.counts.output.angle;
            self.load.ahead = count * self.pace.ahead::<T>();
            self.load.speed = count * pace.over(self.tables.period);
            self.blind.anchored = true;
        }
    }

    /// Goes on without the output encoder.
    fn do_without(&mut self) {
        self.counts.imply();
        self.load.speed = self.drive.speed * self.tables.levers.per_ratio;
        self.load.torque = self.supervisor.torque_before();
        self.blind = Blind::default();
        // The link is where the teeth allow it to be; where exactly, the next contact shows.
        let side: T = sign(self.estimates.contact);
        let [half_gap, _] = self.shape();
        let implied = self.now();
        self.load.ahead += (implied.way - implied.shift - side * half_gap).over(self.tables.levers.output);
    }

    /// Whether the motor has gone on by more than gap and shafts let it while the output's counts stood still: a link that
    /// sticks does not let it, wherever the teeth are, which may not be known yet.
    #[cold]
    fn outruns(&self, went_on: T, force: T) -> bool {
        let tables = self.tables;
        let known = &self.knowledge;
        let [half_gap, _] = self.shape();
        let [width_variance, ..] = known.variances;
        let count = tables.counts.output.angle * tables.levers.output;
        let gap = T::TWO * (half_gap + T::THREE * width_variance.square_root());
        went_on > gap + count + T::TWO * (tables.supervisor.margin + known.softness * magnitude(force))
    }

    /// What a way beyond the flanks is.
    #[cold]
    fn far_place(&self, way: T, force: T) -> Place {
        let [half_gap, compliance] = self.shape();
        let (beyond, force) = if way > T::ZERO { (way, force) } else { (-way, -force) };
        let wind_up = if force > T::ZERO { compliance * force } else { T::ZERO };
        let beyond = beyond - wind_up - self.knowledge.reach;
        if beyond < T::ZERO {
            Place::Possible
        } else if beyond < half_gap {
            Place::Worn
        } else {
            Place::Impossible
        }
    }

    /// Contact: by force where there is enough of it; otherwise it lasts until the link has left the flank for sure.
    pub(super) fn contact_unseen(&self, now: &Now<T>) -> ContactState {
        if self.blind.felt != ContactState::Separated {
            return self.blind.felt;
        }
        let before = self.estimates.reported_contact;
        let [half_gap, _] = self.shape();
        let left = half_gap - sign::<T>(before) * (now.way - now.shift);
        let noise = T::TWO * self.tables.contact.way_variance + self.drift_variance();
        if left > T::ZERO && left * left > T::TWO * T::TWO * noise { ContactState::Separated } else { before }
    }

    /// Corrects the load side by what contact shows.
    fn feel(&mut self, now: &Now<T>) {
        let levers = &self.tables.levers;
        let [half_gap, compliance] = self.shape();
        self.blind.force += (now.force - self.blind.force) * self.tables.contact.smoothing;
        let deviation = self.knowledge.mean_force_deviation;
        let held = self.blind.felt;
        // Only what no bias can be: four deviations make contact, three keep it.
        let double = T::TWO * deviation;
        self.blind.felt = with_hysteresis(held, self.blind.force, T::TWO * double, double + deviation);
        let side: T = sign(self.blind.felt);
        let surprise = (now.way - now.shift - side * half_gap - compliance * now.force) * levers.per_output;
        if self.blind.felt == ContactState::Separated {
            self.blind.open_for = self.blind.open_for.saturating_add(1);
            // Beyond an edge there is contact, however light: the link goes with the motor.
            let way = now.way - now.shift;
            if magnitude(way) > half_gap {
                let edge = if way > T::ZERO { half_gap } else { -half_gap };
                self.load.ahead += (way - edge) * levers.per_output;
                self.load.speed = self.drive.speed * levers.per_ratio;
            }
        } else if self.blind.felt == held {
            self.load.take(&self.tables.load.blind_gain, surprise);
            self.blind.open_for = 0;
            self.blind.bounce -= self.blind.bounce * self.tables.contact.smoothing * T::EIGHTH;
        } else {
            // A landing says where the link is, and that it goes with the motor; of its torque it says nothing.
            self.blind.bounce += magnitude(now.rate);
            self.load.ahead += surprise;
            self.load.speed = self.drive.speed * levers.per_ratio;
            self.blind.open_for = 0;
            self.blind.anchored = true;
        }
    }

    /// Variance of the gap coordinate without an output encoder [m^2]; `None` where nothing is known of it.
    pub(super) fn blind_variance(&self) -> Option<T> {
        let edge = self.knowledge.edge_deviation;
        self.blind.anchored.then(|| edge * edge + self.tables.contact.way_variance + self.drift_variance())
    }

    /// What has been added since contact was last felt [m^2].
    fn drift_variance(&self) -> T {
        let load = &self.tables.load;
        let open_for = if self.blind.open_for > 0 { i32::from(self.blind.open_for) + GONE_BEFORE } else { 0 };
        let time = self.tables.period * T::from_i32(open_for);
        let [speed_variance, torque_variance] = load.blind_variance;
        let lever = self.tables.levers.output;
        let bounce = self.blind.bounce;
        let by_torque = time * load.way_per_torque;
        (bounce * bounce + lever * lever * speed_variance + by_torque * by_torque * torque_variance) * time * time
    }

    /// Once an interval: takes the output encoder back when it turns with the motor again. If it does so elsewhere than
    /// was learnt, everything is learnt anew.
    pub(super) fn reconsider(&mut self, settled: Option<T>, mesh: &[T; 2], force: T) {
        let tables = self.tables;
        let phase = self.counts.motor.phase(&tables.counts.motor);
        let output = self.counts.output.phase(&tables.counts.output);
        let free = regressors::free(self.load.speed, phase, Some(output));
        let measured = tables.counts.length * small(self.counts.difference) + tables.levers.sun * self.drive.ahead;
        let room = tables.supervisor.margin + T::TWO * self.knowledge.edge_deviation;
        let settled = settled.map(|side| {
            let beyond = measured - self.learner.way(&Touch { side, force, mesh: *mesh }.on(&free));
            (side, beyond, room)
        });
        // A link that turns with the motor between the flanks is seen as it was, whether or not teeth are felt.
        let way = measured - self.learner.way(&free) - self.error(mesh);
        let between = self.far_place(way, force) == Place::Possible;
        let Some(back) = self.supervisor.reconsider(&tables.supervisor, settled, between, output) else { return };
        self.counts.trust();
        self.load.ahead = T::ZERO;
        self.find_places();
        if back == Return::Otherwise {
            self.anchor = Anchor::new();
            self.learner.reopen();
        }
    }
}

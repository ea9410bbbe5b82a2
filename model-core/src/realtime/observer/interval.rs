//! Learning interval by interval: means over a few periods, what they show, and what is made of it. The learning itself
//! is left to `learner` and `bias`.

use super::block::Settled;
use super::contact::sign;
use super::learner::Regressors;
use super::motion::{Shown, magnitude};
use super::regressors::{OFFSET, Touch};
use super::{Now, Observer, Source};
use crate::mesh::ContactState;
use crate::real::Real;

/// Intervals of rest on a flank after which contact counts as settled: the window of the speed has passed, and the
/// swing of an impact with it.
const SETTLED_AFTER: u32 = 3;

/// Intervals well inside the gap after which the mesh force counts as gone from the motor side's estimate.
const OPEN_AFTER: u32 = 3;

/// Sums over the periods of an interval.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval<T: Real, const P: usize> {
    periods: u32,
    free: Regressors<T, P>,
    mesh: [T; 2],
    raw: T,
    lost: T,
    force: T,
    direction: T,
    speed: T,
    /// Side on which contact settled last, unless the teeth have left it since.
    side: T,
    /// Mesh force over a few intervals [N].
    pub steady: T,
    /// Intervals in a row well inside the gap.
    open_for: u32,
}

impl<T: Real, const P: usize> Interval<T, P> {
    pub fn new() -> Self {
        Self {
            periods: 0,
            free: [T::ZERO; P],
            mesh: [T::ZERO; 2],
            raw: T::ZERO,
            lost: T::ZERO,
            force: T::ZERO,
            direction: T::ZERO,
            speed: T::ZERO,
            side: T::ZERO,
            steady: T::ZERO,
            open_for: 0,
        }
    }

    /// Adds a period; true when the interval is full.
    fn add(&mut self, now: &Now<T, P>, speed: T, periods: u32) -> bool {
        for (sum, value) in self.free.iter_mut().zip(&now.free) {
            *sum += *value;
        }
        for (sum, value) in self.mesh.iter_mut().zip(&now.mesh) {
            *sum += *value;
        }
        self.raw += now.raw;
        self.lost += now.lost;
        self.force += now.force;
        self.direction += now.direction;
        self.speed += speed;
        self.periods += 1;
        self.periods >= periods
    }

    /// Sums become means.
    fn close(&mut self, per_periods: T) -> Self {
        let mut mean = *self;
        mean.free.iter_mut().chain(&mut mean.mesh).for_each(|sum| *sum *= per_periods);
        for sum in [&mut mean.raw, &mut mean.lost, &mut mean.force, &mut mean.direction, &mut mean.speed] {
            *sum *= per_periods;
        }
        *self = Self { side: self.side, steady: self.steady, open_for: self.open_for, ..Self::new() };
        mean
    }
}

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Adds the period to the interval and learns at its end.
    pub(super) fn learn(&mut self, now: &Now<T, P>) {
        let tables = self.tables;
        if !self.interval.add(now, self.drive.speed, tables.learner.periods) {
            return;
        }
        let mean = self.interval.close(tables.learner.per_periods);
        let way = mean.raw - self.learner.way(&mean.free);
        let [_, compliance] = self.shape();
        let unmapped = if self.knowledge.width_is_known { T::EIGHTH } else { T::ONE };
        let turned = magnitude(mean.speed) * tables.learner.span;
        let blur = tables.contact.still_per_speed * unmapped * turned;
        let less_wind_up = way - compliance * mean.force;
        let [_, _, compliance_variance, _] = self.knowledge.variances;
        let softness = T::TWO * compliance_variance.square_root();
        let read = (mean.lost, mean.direction);
        let shown = self.motion.step(&tables.contact, less_wind_up, read, blur, softness);
        self.interval.steady += (mean.force - self.interval.steady) * T::HALF * T::HALF;
        let shift = self.error(&mean.mesh);
        let side = self.settled_side(&mean, way, shift, shown);
        if self.supervisor.source() == Source::Both {
            self.supervisor.remember(self.load.torque);
        } else {
            self.reconsider(side, &mean.mesh, mean.force);
        }
        self.take_bias(&mean, way - shift, shown);
        self.bias.age(&tables.contact);
        self.learner.forget(tables.learner.forgetting);
        self.interval.side = match (side, shown) {
            (Some(side), _) => side,
            (None, Shown::Crossing(..)) => T::ZERO,
            (None, _) => self.interval.side,
        };
        self.knowledge.settled = side.is_some();
        self.contradict(way - shift, shown);
        let settled = Settled { free: &mean.free, mesh: &mean.mesh, raw: mean.raw, force: mean.force };
        // Teeth at rest are on a flank while the motor turns, even if no force says on which.
        let [half_gap, _] = self.shape();
        let told_by_way = rests(shown) && !self.knowledge.width_is_known && self.motion.is_sharp(half_gap);
        let unknown = told_by_way.then_some(T::ZERO);
        let seen = side.or(unknown).filter(|_| self.supervisor.source() == Source::Both);
        if let Some((regressors, way)) = self.block.add(&settled, seen, &tables.learner) {
            self.take_rest(&regressors, way);
        }
        let nearer = if way < shift { -T::ONE } else { T::ONE };
        let mut seen = mean.free;
        if let (Some(offset), false) = (seen.get_mut(OFFSET), self.supervisor.source() == Source::Both) {
            // Without an output encoder there is no offset to be wrong.
            *offset = T::ZERO;
        }
        let touch = Touch { side: nearer, force: T::ZERO, mesh: mean.mesh };
        self.knowledge.of_force(tables, &self.bias, mean.direction);
        self.knowledge.next(tables, &self.learner, &seen, &touch);
        self.say_learnt();
    }

    /// The side on which contact has settled, if any.
    fn settled_side(&self, mean: &Interval<T, P>, way: T, shift: T, shown: Shown<T>) -> Option<T> {
        if !rests(shown) {
            return None;
        }
        let known = &self.knowledge;
        if known.width_is_known && self.supervisor.source() == Source::Both {
            let (contact, _) = self.by_position(way, T::ZERO, shift).contact(
                ContactState::Separated,
                mean.force,
                known.both_deviation,
            );
            let side: T = sign(contact);
            return (contact != ContactState::Separated).then_some(side);
        }
        // A flank that nothing has left since takes less to be believed.
        let twice = T::TWO * known.steady_force_deviation;
        let thrice = twice + known.steady_force_deviation;
        let (force, before) = (self.interval.steady, self.interval.side);
        let needed = |side: T| if before * side > T::ZERO { twice } else { thrice };
        if force > needed(T::ONE) {
            Some(T::ONE)
        } else if -force > needed(-T::ONE) {
            Some(-T::ONE)
        } else {
            None
        }
    }

    /// Reads the torque bias where the gap is open for sure.
    fn take_bias(&mut self, mean: &Interval<T, P>, way: T, shown: Shown<T>) {
        let contact = &self.tables.contact;
        let [half_gap, _] = self.shape();
        let inside = half_gap - self.knowledge.blur - self.knowledge.blur;
        let open = self.knowledge.width_is_known && magnitude(way) < inside;
        self.interval.open_for = if open { self.interval.open_for.saturating_add(1) } else { 0 };
        let read = match shown {
            _ if self.supervisor.source() != Source::Both => None,
            _ if self.interval.open_for >= OPEN_AFTER => Some((mean.lost, mean.direction)),
            Shown::Crossing(lost, direction) if !self.knowledge.width_is_known => Some((lost, direction)),
            _ => None,
        };
        if let Some((lost, direction)) = read {
            self.bias.learn(contact, lost, direction);
        }
    }
}

/// Whether the teeth have been at rest for long enough.
pub(super) fn rests<T: Real>(shown: Shown<T>) -> bool {
    matches!(shown, Shown::Still(intervals) if intervals >= SETTLED_AFTER)
}

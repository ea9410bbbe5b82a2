//! A learning interval: means over a few periods, and what is known at its end. What is done with either is left to the
//! observer.

use super::contact::sign;
use super::learner::{Learner, Regressors};
use super::motion::{Shown, magnitude};
use super::regressors::{COMPLIANCE, HALF_GAP, OFFSET, SKEW, Touch};
use super::{Bias, Now, Observer, Source, regressors};
use crate::mesh::ContactState;
use crate::real::Real;
use crate::tables::observer::{LearnerTable, ObserverTables};

/// Intervals of rest on a flank after which contact counts as settled: the window of the speed has passed, and the
/// swing of an impact with it.
const SETTLED_AFTER: u32 = 3;

/// Intervals well inside the gap after which the mesh force counts as gone from the motor side's estimate.
const OPEN_AFTER: u32 = 3;

/// Surprise, in standard deviations, that does not belong to the model.
const GATE: i32 = 5;

/// Surprises in a row after which what was learnt counts as wrong.
const TOO_MANY: u32 = 12;

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
    /// Intervals in a row well inside the gap.
    open_for: u32,
    surprises: u32,
}

/// What is known at the end of an interval and serves until the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knowledge<T: Real> {
    /// Standard deviation of the mesh force from the motor side [N].
    pub force_deviation: T,
    /// The same over an interval.
    pub mean_force_deviation: T,
    /// The same with the position's help.
    pub both_deviation: T,
    /// Variance of the way with everything taken out that was learnt [m^2].
    pub way_variance: T,
    /// Variance of the way less the nearer edge [m^2].
    pub edge_variance: T,
    /// Its root [m].
    pub edge_deviation: T,
    /// Variance of where a flank is: half-gap and transmission error [m^2].
    pub flank_variance: T,
    /// Variances of half-gap [m^2], offset [m^2], compliance [m^2/N^2] and skew [m^2 s^2].
    pub variances: [T; 4],
    /// Distance from an edge that noise and ignorance can make [m].
    pub blur: T,
    /// Weight of the position beside the motor side in the mesh force.
    pub position_weight: T,
    /// Whether positions decide about contact.
    pub width_is_known: bool,
    /// The last interval was in settled contact.
    pub settled: bool,
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
            open_for: 0,
            surprises: 0,
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
        *self = Self { open_for: self.open_for, surprises: self.surprises, ..Self::new() };
        mean
    }
}

/// Intervals of settled contact in a row, gathered into one way to learn from: noise of the mesh force that is left in
/// a regressor would make the compliance look smaller than it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<T: Real, const P: usize> {
    intervals: u32,
    touch: Touch<T>,
    free: Regressors<T, P>,
    raw: T,
}

impl<T: Real, const P: usize> Block<T, P> {
    pub fn new() -> Self {
        Self { intervals: 0, touch: Touch::default(), free: [T::ZERO; P], raw: T::ZERO }
    }

    /// Adds an interval; gives regressors and way when enough have passed on one side.
    fn add(
        &mut self,
        mean: &Interval<T, P>,
        side: Option<T>,
        table: &LearnerTable<T>,
    ) -> Option<(Regressors<T, P>, T)> {
        let Some(side) = side else {
            *self = Self::new();
            return None;
        };
        if side != self.touch.side {
            *self = Self::new();
            self.touch.side = side;
        }
        let free = self.free.iter_mut().zip(&mean.free);
        for (sum, value) in free.chain(self.touch.mesh.iter_mut().zip(&mean.mesh)) {
            *sum += *value * table.per_block;
        }
        self.raw += mean.raw * table.per_block;
        self.touch.force += mean.force * table.per_block;
        self.intervals += 1;
        if self.intervals < table.block {
            return None;
        }
        let full = (self.touch.on(&self.free), self.raw);
        *self = Self::new();
        self.touch.side = side;
        Some(full)
    }
}

impl<T: Real> Knowledge<T> {
    /// Beforehand.
    pub fn new<const P: usize>(tables: &ObserverTables<T>, learner: &Learner<T, P>) -> Self {
        let mut knowledge = Self {
            force_deviation: T::ZERO,
            mean_force_deviation: T::ZERO,
            both_deviation: T::ZERO,
            way_variance: T::ZERO,
            edge_variance: T::ZERO,
            edge_deviation: T::ZERO,
            flank_variance: T::ZERO,
            variances: [T::ZERO; 4],
            blur: T::ZERO,
            position_weight: T::ZERO,
            width_is_known: false,
            settled: false,
        };
        let free = regressors::free(T::ZERO, 0, Some(0));
        let touch = Touch { side: T::ONE, ..Touch::default() };
        knowledge.refresh(tables, learner, &Bias::new(&tables.contact), &free, &touch, T::ZERO);
        knowledge
    }

    fn refresh<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        learner: &Learner<T, P>,
        bias: &Bias<T>,
        free: &Regressors<T, P>,
        touch: &Touch<T>,
        direction: T,
    ) {
        let contact = &tables.contact;
        let known = bias.variance_at(direction) + contact.ripple_variance;
        let force = known + contact.force_variance;
        self.force_deviation = force.square_root();
        self.mean_force_deviation = (known + contact.force_variance * tables.learner.per_periods).square_root();
        self.way_variance = learner.variance(&tables.learner, free);
        self.edge_variance = learner.variance(&tables.learner, &touch.on(free));
        self.flank_variance = learner.variance(&tables.learner, &touch.on(&[T::ZERO; P]));
        self.edge_deviation = self.edge_variance.square_root();
        self.variances =
            [HALF_GAP, OFFSET, COMPLIANCE, SKEW].map(|parameter| learner.variance_of(&tables.learner, parameter));
        let edge = self.edge_variance + contact.way_variance;
        self.blur = T::TWO * edge.square_root();
        let compliance = learner.value(COMPLIANCE);
        // Weights in inverse proportion to the variances, both as way.
        let from_force = force * compliance * compliance;
        self.position_weight = from_force.over(from_force + edge);
        self.both_deviation = (force * (T::ONE - self.position_weight)).square_root();
        let half_gap = learner.value(HALF_GAP);
        let tenth = half_gap * tables.contact.known_part;
        self.width_is_known = self.edge_variance < tenth * tenth;
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
        self.knowledge.settled = side.is_some();
        let seen = side.filter(|_| self.supervisor.source() == Source::Both);
        if let Some((regressors, way)) = self.block.add(&mean, seen, &tables.learner) {
            self.take_way(&regressors, way);
        }
        let nearer = if way < shift { -T::ONE } else { T::ONE };
        let mut seen = mean.free;
        if let (Some(offset), false) = (seen.get_mut(OFFSET), self.supervisor.source() == Source::Both) {
            // Without an output encoder there is no offset to be wrong.
            *offset = T::ZERO;
        }
        let touch = Touch { side: nearer, force: T::ZERO, mesh: mean.mesh };
        self.knowledge.refresh(tables, &self.learner, &self.bias, &seen, &touch, mean.direction);
    }

    /// The side on which contact has settled, if any.
    fn settled_side(&self, mean: &Interval<T, P>, way: T, shift: T, shown: Shown<T>) -> Option<T> {
        let still = matches!(shown, Shown::Still(intervals) if intervals >= SETTLED_AFTER);
        if !still {
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
        let needed = T::TWO * known.mean_force_deviation + known.mean_force_deviation;
        if mean.force > needed {
            Some(T::ONE)
        } else if -mean.force > needed {
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

    /// Takes a way in settled contact into the learner, unless it does not belong to the model.
    fn take_way(&mut self, regressors: &Regressors<T, P>, way: T) {
        let table = &self.tables.learner;
        let surprise = way - self.learner.way(regressors);
        let variance = self.learner.variance(table, regressors) + table.noise * table.noise;
        if surprise * surprise > T::from_i32(GATE * GATE) * variance {
            self.interval.surprises += 1;
            if self.interval.surprises >= TOO_MANY {
                self.interval.surprises = 0;
                self.learner.reopen();
            }
            return;
        }
        self.interval.surprises = 0;
        self.learner.learn(table, regressors, way);
    }
}

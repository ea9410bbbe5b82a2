//! Learning interval by interval: means over a few periods, what they show, and what is made of it at once. What
//! can wait is left to `parts`, the learning itself to `learner` and `bias`.

use super::block::Settled;
use super::contact::sign;
use super::motion::{Shown, magnitude};
use super::parts::Part;
use super::{Now, Observer};
use crate::mesh::ContactState;
use crate::real::Real;

/// Intervals of rest on a flank after which contact counts as settled: the window of the speed has passed, and the
/// swing of an impact with it.
const SETTLED_AFTER: u8 = 3;

/// Intervals over which the force of a rest is averaged at most.
const LONG_REST: u8 = 16;

/// Intervals well inside the gap after which the mesh force counts as gone from the motor side's estimate.
const OPEN_AFTER: u8 = 3;

/// Sums over the periods of an interval, and what lasts longer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval<T: Real> {
    periods: u16,
    sums: Mean<T>,
    pub part: Part,
    /// Direction of the motor's dry friction, mean over the last interval.
    pub direction: T,
    /// Nearer side of the gap then.
    pub nearer: T,
    /// Flank of the last rest that was learnt from.
    pub learnt_on: ContactState,
    /// Side on which contact settled last, unless the teeth have left it since.
    side: T,
    /// Mesh force over the last interval [N].
    force: T,
    /// Flank on which the teeth were pressed then.
    pressed: ContactState,
    /// Mesh force over a few intervals [N].
    pub steady: T,
    /// Mesh force over the whole rest, landing included [N].
    pub rested: T,
    /// Intervals in a row well inside the gap.
    open_for: u8,
}

/// What is averaged.
#[derive(Debug, Clone, Copy)]
struct Mean<T: Real> {
    raw: T,
    lost: T,
    force: T,
    direction: T,
}

impl<T: Real> Mean<T> {
    const NONE: Self = Self { raw: T::ZERO, lost: T::ZERO, force: T::ZERO, direction: T::ZERO };
}

impl<T: Real> Interval<T> {
    pub fn new() -> Self {
        Self {
            periods: 0,
            sums: Mean::NONE,
            part: Part::Done,
            direction: T::ZERO,
            nearer: T::ONE,
            learnt_on: ContactState::Separated,
            side: T::ZERO,
            force: T::ZERO,
            pressed: ContactState::Separated,
            steady: T::ZERO,
            rested: T::ZERO,
            open_for: 0,
        }
    }

    fn add(&mut self, now: &Now<T>) {
        self.sums.raw += now.raw;
        self.sums.lost += now.lost;
        self.sums.force += now.force;
        self.sums.direction += now.direction;
        self.periods += 1;
    }

    /// Sums become means.
    fn close(&mut self, per_periods: T) -> Mean<T> {
        let Mean { raw, lost, force, direction } = core::mem::replace(&mut self.sums, Mean::NONE);
        self.periods = 0;
        Mean {
            raw: raw * per_periods,
            lost: lost * per_periods,
            force: force * per_periods,
            direction: direction * per_periods,
        }
    }
}

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Adds the period to the interval, and does a part of what the last one gave to do.
    pub(super) fn learn(&mut self, now: &Now<T>) {
        let table = &self.tables.learner;
        self.interval.add(now);
        if self.interval.periods == table.middle {
            // Where few periods make an interval, the rest of the last one's work is due now.
            while self.interval.part != Part::Done {
                self.go_on_learning();
            }
            self.keep_places();
        } else if self.interval.part != Part::Done {
            self.go_on_learning();
        }
        if self.interval.periods >= table.periods {
            self.close_interval();
        }
    }

    /// What the interval showed.
    fn close_interval(&mut self) {
        let tables = self.tables;
        let mean = self.interval.close(tables.learner.per_periods);
        let (free, mesh) = (self.places.free, self.places.mesh_then);
        let way = mean.raw - self.learner.way(&free);
        let [_, compliance] = self.shape();
        let turned = magnitude(self.drive.speed) * tables.learner.span;
        // Until the width is known, what is learnt of the transmission error hides no crossing; it is left in afterwards.
        let (unlearnt, blur, known_shift) = if self.knowledge.width_is_known {
            (T::ZERO, tables.contact.still_per_speed * T::EIGHTH, T::ZERO)
        } else {
            let (unlearnt, learnt) = self.learner.error_deviation(&tables.learner);
            let per_turned = T::TWO * tables.counts.mesh_periods * tables.levers.per_ratio;
            (unlearnt, tables.contact.still_per_speed - per_turned * learnt, self.error(&mesh))
        };
        let less_wind_up = way - compliance * mean.force - known_shift;
        let read = (mean.lost, mean.direction);
        let shown = self.motion.step(&tables.contact, less_wind_up, read, blur * turned, self.knowledge.softness);
        let steady_rise = (mean.force - self.interval.steady) * T::QUARTER;
        self.interval.steady += steady_rise;
        let rested = if let Shown::Still(intervals) = shown { i32::from(intervals.min(LONG_REST)) } else { 1 };
        self.interval.rested += (mean.force - self.interval.rested).over(T::from_i32(rested));
        let shift = self.error(&mesh);
        let side = self.settled_side(&mean, way, shift, shown);
        if self.supervisor.sees_both() {
            self.supervisor.remember(self.load.torque);
        } else {
            self.reconsider(side, &mesh, mean.force);
        }
        self.take_bias(&mean, way - shift, shown);
        self.bias.age(&tables.contact);
        self.interval.side = match (side, shown) {
            (Some(side), _) => side,
            (None, Shown::Crossing(..)) => T::ZERO,
            (None, _) => self.interval.side,
        };
        self.knowledge.settled = side.is_some();
        self.contradict(way - shift, shown);
        // Teeth at rest are on a flank while the motor turns, even if no force says on which. Where the transmission error
        // could hide a crossing, it has to be learnt before that can be said of any rest.
        let [half_gap, _] = self.shape();
        let wide = self.anchor.ride().half_gap_at_least(half_gap);
        let told_by_way = rests(shown)
            && !self.knowledge.width_is_known
            && (unlearnt > wide * T::QUARTER || self.motion.is_sharp(wide));
        let unknown = told_by_way.then_some(T::ZERO);
        // A motor that stands still says the same again and again, rounded by its encoder, under a force that its friction
        // hides: that is worth learning once on either flank.
        let turns = magnitude(mean.direction) > T::HALF;
        let rise = mean.force - core::mem::replace(&mut self.interval.force, mean.force);
        let pressed = self.pressed(way - shift, mean.force, rise);
        let pressed_before = core::mem::replace(&mut self.interval.pressed, pressed);
        // The first millisecond of a landing is not learnt from.
        let pressed = (pressed != ContactState::Separated && pressed == pressed_before).then(|| sign(pressed));
        let told_by_force = side.or(pressed).filter(|side| self.lasts(*side, steady_rise));
        let seen = told_by_force.or(unknown).filter(|side| {
            self.supervisor.sees_both() && (turns || *side != T::ZERO && *side != sign(self.interval.learnt_on))
        });
        if seen.is_none() {
            self.anchor.interrupt();
        }
        let force = mean.force + tables.learner.force_lag * rise;
        let settled = Settled { free: &free, mesh: &mesh, raw: mean.raw, force };
        let least = self.least_intervals();
        let full = self.block.add(&settled, seen, least, &tables.learner);
        self.interval.part = Part::Answer(full);
        self.interval.direction = mean.direction;
        self.interval.nearer = if way < shift { -T::ONE } else { T::ONE };
    }

    /// The side on which contact has settled, if any.
    fn settled_side(&self, mean: &Mean<T>, way: T, shift: T, shown: Shown<T>) -> Option<T> {
        if !rests(shown) {
            return None;
        }
        let known = &self.knowledge;
        if known.width_is_known && self.supervisor.sees_both() {
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
    fn take_bias(&mut self, mean: &Mean<T>, way: T, shown: Shown<T>) {
        let contact = &self.tables.contact;
        let [half_gap, _] = self.shape();
        // Near the flanks a motor that crosses in a moment brakes, and teeth land before the way says so.
        let (blur, near) = (self.knowledge.blur, T::EIGHTH * half_gap);
        let inside = half_gap - T::TWO * if blur > near { blur } else { near };
        let open = self.knowledge.width_is_known && magnitude(way) < inside;
        self.interval.open_for = if open { self.interval.open_for.saturating_add(1) } else { 0 };
        let read = match shown {
            _ if !self.supervisor.sees_both() => None,
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

//! Learning interval by interval: what the means of a few periods show, and what is made of it at once. What can wait is
//! left to `parts`, the learning itself to `learner` and `bias`.

use super::block::Settled;
use super::contact::sign;
use super::interval::{Mean, Part, rests};
use super::motion::{Shown, magnitude};
use super::now::Now;
use super::state::Observer;
use crate::numbers::Real;
use parameters::ContactState;

/// Intervals over which the force of a rest is averaged at most.
const LONG_REST: u8 = 16;

/// Intervals well inside the gap after which the mesh force counts as gone from the motor side's estimate.
const OPEN_AFTER: u8 = 3;

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

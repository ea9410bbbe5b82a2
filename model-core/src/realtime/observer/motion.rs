//! Whether the teeth are on their way through the gap or at rest on a flank, from how the way less the wind-up moves:
//! needs neither width nor error map, so it is what learning begins with. Which flank it is, the force says.

use crate::real::Real;
use crate::tables::observer::ContactTable;

/// Learning intervals over which the speed is taken.
const WINDOW: usize = 8;

/// A few intervals of way less wind-up, and of force with direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion<T: Real> {
    ways: [T; WINDOW + 1],
    forces: [(T, T); WINDOW + 1],
    /// Where the newest of them is.
    at: usize,
    known: usize,
    still_for: u32,
    /// Way over the window below which nothing was seen to move [m].
    limit: T,
}

/// What an interval showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shown<T: Real> {
    /// At rest for so many intervals.
    Still(u32),
    /// Through the gap half a window ago; force and direction then.
    Crossing(T, T),
    /// Neither for sure.
    Between,
}

impl<T: Real> Motion<T> {
    pub fn new() -> Self {
        Self {
            ways: [T::ZERO; WINDOW + 1],
            forces: [(T::ZERO, T::ZERO); WINDOW + 1],
            at: 0,
            known: 0,
            still_for: 0,
            limit: T::ZERO,
        }
    }

    /// Takes in one interval. `blur` is what error maps that are unknown can make of the motor's turning in an
    /// interval [m], and `softness` by how much the compliance may be wrong [m/N].
    pub fn step(&mut self, table: &ContactTable<T>, way: T, force: (T, T), blur: T, softness: T) -> Shown<T> {
        self.at = if self.at < WINDOW { self.at + 1 } else { 0 };
        if let (Some(newest_way), Some(newest_force)) = (self.ways.get_mut(self.at), self.forces.get_mut(self.at)) {
            *newest_way = way;
            *newest_force = force;
        }
        if self.known < WINDOW {
            self.known += 1;
            return Shown::Between;
        }
        let (oldest, oldest_force) = self.ago(WINDOW, way, force);
        let (middle, middle_force) = self.ago(WINDOW / 2, way, force);
        let limit = (table.still + blur) * T::from_i32(WINDOW as i32) + softness * magnitude(force.0 - oldest_force.0);
        self.limit = limit;
        let whole = way - oldest;
        if magnitude(whole) < limit {
            self.still_for = self.still_for.saturating_add(1);
            return Shown::Still(self.still_for);
        }
        self.still_for = 0;
        let on = |part: T| part > limit && whole > T::ZERO || -part > limit && whole < T::ZERO;
        if on(way - middle) && on(middle - oldest) {
            let (force, direction) = middle_force;
            Shown::Crossing(force, direction)
        } else {
            Shown::Between
        }
    }

    /// Way and force of some intervals ago.
    fn ago(&self, intervals: usize, way: T, force: (T, T)) -> (T, (T, T)) {
        let at = if self.at >= intervals { self.at - intervals } else { self.at + WINDOW + 1 - intervals };
        (self.ways.get(at).copied().unwrap_or(way), self.forces.get(at).copied().unwrap_or(force))
    }

    /// Whether standing still tells rest from a slow crossing of a gap: nothing as wide could have hidden in the noise.
    pub fn is_sharp(&self, half_gap: T) -> bool {
        self.limit < half_gap * T::QUARTER
    }
}

/// |value|.
pub(super) fn magnitude<T: Real>(value: T) -> T {
    value.abs()
}

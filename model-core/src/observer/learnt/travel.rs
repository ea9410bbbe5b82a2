//! Whether the teeth are on their way through the gap or at rest on a flank, from how the deflection less the wind-up
//! moves: needs neither half-gap nor error map, so it is what learning begins with. Which flank it is, the force says.

use crate::numbers::Real;
use crate::observer::tables::ContactTable;

/// Learning intervals over which the speed is taken.
const WINDOW: usize = 8;

/// Parts into which a direction from -1 to 1 is rounded: far finer than noise leaves it.
const FINE: i32 = 64;

/// A few intervals of deflection less wind-up, and of force with direction.
#[derive(Debug, Clone, Copy)]
pub struct TravelDetector<T: Real> {
    deflections: [T; WINDOW + 1],
    forces: [T; WINDOW + 1],
    /// Directions of the motor's dry friction, in parts of [`FINE`].
    directions: [i8; WINDOW + 1],
    /// Where the newest of them is.
    at: u8,
    known: u8,
    still_for: u8,
    /// Deflection over the window below which nothing was seen to move [m].
    limit: T,
}

/// What an interval showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel<T: Real> {
    /// At rest for so many intervals.
    AtRest(u8),
    /// Through the gap half a window ago; force [N] and direction of friction then.
    Crossing(T, T),
    /// Neither for sure.
    Undecided,
}

impl<T: Real> TravelDetector<T> {
    /// Part of the half-gap that noise may hide in a window of rest [-].
    const HIDDEN: T = T::QUARTER;

    /// A constant, so that the compiler writes it to its place instead of copying one from the stack.
    const NEW: Self = Self {
        deflections: [T::ZERO; WINDOW + 1],
        forces: [T::ZERO; WINDOW + 1],
        directions: [0; WINDOW + 1],
        at: 0,
        known: 0,
        still_for: 0,
        limit: T::ZERO,
    };

    #[inline(always)]
    pub fn new() -> Self {
        Self::NEW
    }

    /// Takes in one interval: deflection less wind-up [m], and force [N] with direction. `blur` is what error maps that
    /// are unknown can make of the motor's turning in an interval [m], and `softness` by how much the compliance may be
    /// wrong [m/N].
    pub fn step(
        &mut self,
        table: &ContactTable<T>,
        deflection: T,
        (force, direction): (T, T),
        blur: T,
        softness: T,
    ) -> Travel<T> {
        self.at = if usize::from(self.at) < WINDOW { self.at + 1 } else { 0 };
        let at = usize::from(self.at);
        if let (Some(newest_deflection), Some(newest_force), Some(newest_direction)) =
            (self.deflections.get_mut(at), self.forces.get_mut(at), self.directions.get_mut(at))
        {
            *newest_deflection = deflection;
            *newest_force = force;
            *newest_direction = (direction * T::from_i32(FINE)).to_i64() as i8;
        }
        if usize::from(self.known) < WINDOW {
            self.known += 1;
            return Travel::Undecided;
        }
        let (oldest, middle) = (self.ago(WINDOW), self.ago(WINDOW / 2));
        let of = |values: &[T; WINDOW + 1], at: usize| values.get(at).copied().unwrap_or(T::ZERO);
        let (oldest_deflection, middle_deflection) = (of(&self.deflections, oldest), of(&self.deflections, middle));
        let changed = (force - of(&self.forces, oldest)).abs();
        let limit = (table.still + blur) * T::from_i32(WINDOW as i32) + softness * changed;
        self.limit = limit;
        let whole = deflection - oldest_deflection;
        if whole.abs() < limit {
            self.still_for = self.still_for.saturating_add(1);
            return Travel::AtRest(self.still_for);
        }
        self.still_for = 0;
        let on = |part: T| part > limit && whole > T::ZERO || -part > limit && whole < T::ZERO;
        if on(deflection - middle_deflection) && on(middle_deflection - oldest_deflection) {
            let direction = self.directions.get(middle).copied().unwrap_or(0);
            Travel::Crossing(of(&self.forces, middle), T::from_i32(direction.into()).over(T::from_i32(FINE)))
        } else {
            Travel::Undecided
        }
    }

    /// Where that of some intervals ago is.
    fn ago(&self, intervals: usize) -> usize {
        let at = usize::from(self.at);
        if at >= intervals { at - intervals } else { at + WINDOW + 1 - intervals }
    }

    /// Whether standing still tells rest from a slow crossing of a gap: what noise hides is a small part of the half-gap, so nothing as wide could have gone by in a window.
    pub fn tells_rest(&self, half_gap: T) -> bool {
        self.limit < half_gap * Self::HIDDEN
    }
}

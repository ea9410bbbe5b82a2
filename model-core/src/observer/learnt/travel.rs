//! Detection of rest on a flank and of crossings, from the change of the deflection less wind-up. The detection needs
//! neither half-gap nor error map and is therefore the first step of the estimation. The flank follows from the force.

use crate::numbers::Real;
use crate::observer::tables::ContactTable;

/// Learning intervals over which the speed is measured.
const WINDOW: usize = 8;

/// Resolution of a direction from -1 to 1: far finer than its noise.
const FINE: i32 = 64;

/// Deflection less wind-up, force and direction of the last few intervals.
#[derive(Debug, Clone, Copy)]
pub struct TravelDetector<T: Real> {
    deflections: [T; WINDOW + 1],
    forces: [T; WINDOW + 1],
    /// Directions of the motor's dry friction, in parts of [`FINE`].
    directions: [i8; WINDOW + 1],
    /// Index of the newest entry.
    at: u8,
    known: u8,
    still_for: u8,
    /// Change of the deflection over the window below which no motion is detected [m].
    limit: T,
}

/// Travel of the teeth in an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel<T: Real> {
    /// At rest for this number of intervals.
    AtRest(u8),
    /// Crossing of the gap half a window ago; force [N] and direction of friction at that time.
    Crossing(T, T),
    /// Neither rest nor crossing is certain.
    Undecided,
}

impl<T: Real> TravelDetector<T> {
    /// Largest motion hidden by noise in a window of rest, over the half-gap [-].
    const HIDDEN: T = T::QUARTER;

    /// A constant: the compiler writes it in place instead of copying from the stack.
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

    /// Judges an interval by deflection less wind-up [m], and force [N] with direction. `blur` is the deflection that
    /// unknown error maps can cause as the motor turns in an interval [m], `softness` the uncertainty of the compliance
    /// [m/N].
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

    /// Index of the entry some intervals ago.
    fn ago(&self, intervals: usize) -> usize {
        let at = usize::from(self.at);
        if at >= intervals { at - intervals } else { at + WINDOW + 1 - intervals }
    }

    /// Returns true if rest differs from a slow crossing: noise hides only a small part of the half-gap in a window.
    pub fn tells_rest(&self, half_gap: T) -> bool {
        self.limit < half_gap * Self::HIDDEN
    }
}

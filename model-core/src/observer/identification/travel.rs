//! Detection of rest on a flank and of crossings, from the change of the deflection less wind-up. The detection needs
//! neither half-gap nor error map and is therefore the first step of the estimation. The flank follows from the force.

use super::thresholds::EstimatorThresholds;
use crate::numbers::Real;
use crate::observer::tables::ContactTable;

/// Learning intervals over which the speed is measured.
const WINDOW: usize = 8;

/// Resolution of a direction from -1 to 1: far finer than its noise.
const DIRECTION_PARTS: i32 = 64;

/// Deflection less wind-up, force and direction of the last few intervals.
#[derive(Debug, Clone, Copy)]
pub struct TravelDetector<T: Real> {
    deflections: [T; WINDOW + 1],
    forces: [T; WINDOW + 1],
    /// Directions of the motor's dry friction, in parts of [`DIRECTION_PARTS`].
    directions: [i8; WINDOW + 1],
    /// Index of the newest entry.
    newest: u8,
    filled: u8,
    rest_intervals: u8,
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
    const LIMITS: EstimatorThresholds<T> = EstimatorThresholds::TUNED;

    /// A constant: the compiler writes it in place instead of copying from the stack.
    const NEW: Self = Self {
        deflections: [T::ZERO; WINDOW + 1],
        forces: [T::ZERO; WINDOW + 1],
        directions: [0; WINDOW + 1],
        newest: 0,
        filled: 0,
        rest_intervals: 0,
        limit: T::ZERO,
    };

    #[inline(always)]
    pub fn new() -> Self {
        Self::NEW
    }

    /// Judges an interval by deflection less wind-up [m], and force [N] with direction. `blur` is the deflection that
    /// unknown error maps can cause as the motor turns in an interval [m], `compliance_uncertainty` the uncertainty of the compliance
    /// [m/N].
    pub fn step(
        &mut self,
        table: &ContactTable<T>,
        deflection: T,
        (force, direction): (T, T),
        blur: T,
        compliance_uncertainty: T,
    ) -> Travel<T> {
        self.newest = if usize::from(self.newest) < WINDOW { self.newest + 1 } else { 0 };
        let newest = usize::from(self.newest);
        if let (Some(newest_deflection), Some(newest_force), Some(newest_direction)) =
            (self.deflections.get_mut(newest), self.forces.get_mut(newest), self.directions.get_mut(newest))
        {
            *newest_deflection = deflection;
            *newest_force = force;
            *newest_direction = (direction * T::from_i32(DIRECTION_PARTS)).to_i64() as i8;
        }
        if usize::from(self.filled) < WINDOW {
            self.filled += 1;
            return Travel::Undecided;
        }
        let (oldest, middle) = (self.index_before(WINDOW), self.index_before(WINDOW / 2));
        let entry = |values: &[T; WINDOW + 1], index: usize| values.get(index).copied().unwrap_or(T::ZERO);
        let (oldest_deflection, middle_deflection) =
            (entry(&self.deflections, oldest), entry(&self.deflections, middle));
        let force_change = (force - entry(&self.forces, oldest)).abs();
        let limit = (table.still + blur) * T::from_i32(WINDOW as i32) + compliance_uncertainty * force_change;
        self.limit = limit;
        let change = deflection - oldest_deflection;
        if change.abs() < limit {
            self.rest_intervals = self.rest_intervals.saturating_add(1);
            return Travel::AtRest(self.rest_intervals);
        }
        self.rest_intervals = 0;
        let exceeds_limit = |part: T| part > limit && change > T::ZERO || -part > limit && change < T::ZERO;
        if exceeds_limit(deflection - middle_deflection) && exceeds_limit(middle_deflection - oldest_deflection) {
            let direction = self.directions.get(middle).copied().unwrap_or(0);
            Travel::Crossing(entry(&self.forces, middle), T::from_i32(direction.into()) / T::from_i32(DIRECTION_PARTS))
        } else {
            Travel::Undecided
        }
    }

    /// Index of the entry some intervals ago.
    fn index_before(&self, intervals: usize) -> usize {
        let newest = usize::from(self.newest);
        if newest >= intervals { newest - intervals } else { newest + WINDOW + 1 - intervals }
    }

    /// Returns true if rest differs from a slow crossing: noise hides only a small part of the half-gap in a window.
    pub fn distinguishes_rest(&self, half_gap: T) -> bool {
        self.limit < half_gap * Self::LIMITS.hidden_motion
    }
}

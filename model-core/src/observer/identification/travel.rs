//! Detection of rest on a flank and of crossings, from the change of the deflection less wind-up. The detection needs
//! neither half-gap nor error map and is therefore the first step of the estimation. The flank follows from the force.

use super::thresholds::EstimatorThresholds;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
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
state_words! {
    struct TravelDetector<T> {
        deflections, forces, directions, newest, filled, rest_intervals, limit,
    }
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
    pub const NEW: Self = Self {
        deflections: [T::ZERO; WINDOW + 1],
        forces: [T::ZERO; WINDOW + 1],
        directions: [0; WINDOW + 1],
        newest: 0,
        filled: 0,
        rest_intervals: 0,
        limit: T::ZERO,
    };

    /// Judges an interval by deflection less wind-up [m], and force [N] with direction. `blur` is the deflection that
    /// unknown error maps can cause as the motor turns in an interval [m], `compliance_uncertainty` the uncertainty of
    /// the compliance [m/N].
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::contact;

    const UM: f32 = 1e-6;

    /// Steps a detector through deflections [um] at constant force and returns the last result.
    fn steps(detector: &mut TravelDetector<f32>, deflections: impl IntoIterator<Item = f32>) -> Travel<f32> {
        let mut travel = Travel::Undecided;
        for deflection in deflections {
            travel = detector.step(&contact(), deflection * UM, (2.0, 0.5), 0.0, 0.0);
        }
        travel
    }

    fn fresh_steps(deflections: impl IntoIterator<Item = f32>) -> Travel<f32> {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, deflections)
    }

    #[test]
    fn short_history_is_undecided() {
        assert_eq!(fresh_steps([0.0; WINDOW]), Travel::Undecided);
        assert_eq!(fresh_steps([0.0; WINDOW + 1]), Travel::AtRest(1));
    }

    #[test]
    fn change_below_noise_is_rest() {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW]);
        assert_eq!(steps(&mut detector, [7.9]), Travel::AtRest(1));
        assert_eq!(steps(&mut detector, [-7.9]), Travel::AtRest(2));
        assert_eq!(steps(&mut detector, [8.1]), Travel::Undecided);
        assert_eq!(steps(&mut detector, [0.0]), Travel::AtRest(1));
    }

    #[test]
    fn steady_motion_is_crossing() {
        for sign in [1.0, -1.0] {
            let travel = fresh_steps((0..20).map(|interval| sign * 3.0 * interval as f32));
            assert_eq!(travel, Travel::Crossing(2.0, 0.5));
        }
    }

    #[test]
    fn jump_is_undecided() {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW + 1]);
        assert_eq!(steps(&mut detector, [100.0; 3]), Travel::Undecided);
    }

    #[test]
    fn reversal_is_undecided() {
        let there_and_back = (0..5).map(|interval| 10.0 * interval as f32).chain([30.0, 25.0, 20.0, 15.0]);
        assert_eq!(fresh_steps(there_and_back), Travel::Undecided);
    }

    #[test]
    fn blur_widens_rest() {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW]);
        assert_eq!(detector.step(&contact(), 15.9 * UM, (2.0, 0.0), UM, 0.0), Travel::AtRest(1));
    }

    #[test]
    fn changed_force_widens_rest() {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW]);
        assert_eq!(detector.step(&contact(), 15.9 * UM, (10.0, 0.0), 0.0, UM), Travel::AtRest(1));
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW]);
        assert_eq!(detector.step(&contact(), 16.1 * UM, (10.0, 0.0), 0.0, UM), Travel::Undecided);
    }

    #[test]
    fn deflection_of_nan_is_undecided() {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW]);
        assert_eq!(steps(&mut detector, [f32::NAN]), Travel::Undecided);
    }

    #[test]
    fn rest_differs_from_crossing_in_wide_gap() {
        let mut detector = TravelDetector::NEW;
        steps(&mut detector, [0.0; WINDOW + 1]);
        assert!(detector.distinguishes_rest(32.1 * UM), "noise hides 8 um, a quarter of the half-gap");
        assert!(!detector.distinguishes_rest(31.9 * UM));
    }
}

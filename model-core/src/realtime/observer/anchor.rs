//! On which flank teeth came to rest, by how the way has changed since they rested last: upwards is the drive side,
//! whatever force and bias are. Whether they rest at all is left to `motion`.

use core::array;

use super::learner::{Learner, Regressors};
use super::motion::magnitude;
use super::regressors::{HALF_GAP, SKEW};
use crate::real::Real;
use crate::tables::observer::LearnerTable;

/// Standard deviations by which a way must have changed.
const SURE: i32 = 4;

/// Where the teeth rested last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anchor<T: Real, const P: usize> {
    free: Regressors<T, P>,
    way: T,
    /// 1, -1, or 0 for unknown.
    side: T,
    held: bool,
}

impl<T: Real, const P: usize> Anchor<T, P> {
    pub fn new() -> Self {
        Self { free: [T::ZERO; P], way: T::ZERO, side: T::ZERO, held: false }
    }

    /// Remembers a rest.
    pub fn put(&mut self, regressors: &Regressors<T, P>, way: T, side: T) {
        *self = Self { free: *regressors, way, side, held: true };
        if let Some(half_gap) = self.free.get_mut(HALF_GAP) {
            *half_gap = T::ZERO;
        }
    }

    /// Whether the teeth rested on a side last.
    pub fn was_on(&self, side: T) -> bool {
        self.side == side
    }

    /// The side of another rest; 0 if the change is neither more than everything else could make of it, nor so little
    /// that it is the same flank. While the link hardly moves, nothing is said: motor and link may rest with open teeth.
    pub fn side(
        &self,
        table: &LearnerTable<T>,
        learner: &Learner<T, P>,
        regressors: &Regressors<T, P>,
        way: T,
        lever: T,
    ) -> T {
        let half_gap = learner.value(HALF_GAP);
        let speed = regressors.get(SKEW).copied().unwrap_or(T::ZERO);
        let went = magnitude(speed) * lever * table.span * T::from_i32(table.block as i32);
        if !self.held || went < half_gap {
            return T::ZERO;
        }
        let between: Regressors<T, P> = array::from_fn(|i| match (regressors.get(i), self.free.get(i)) {
            (Some(now), Some(before)) if i != HALF_GAP => *now - *before,
            _ => T::ZERO,
        });
        let moved = way - self.way - learner.way(&between);
        let variance = learner.variance(table, &between) + T::TWO * table.noise * table.noise;
        let sure = T::from_i32(SURE * SURE) * variance;
        if moved * moved > sure && magnitude(moved) > half_gap * T::HALF {
            if moved > T::ZERO { T::ONE } else { -T::ONE }
        } else if moved * moved < sure && sure < half_gap * half_gap {
            self.side
        } else {
            T::ZERO
        }
    }
}

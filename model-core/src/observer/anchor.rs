//! On which flank teeth came to rest, by how the way has changed since they rested last: upwards is the drive side,
//! whatever force and bias are. Whether they rest at all is left to `motion`, and whether on a flank to `ride`.

use core::array;

use super::learner::{Learner, Weighed};
use super::motion::magnitude;
use super::regressors::{HALF_GAP, Regressors, SKEW};
use super::ride::{Change, Ride};
use crate::numbers::Real;
use crate::observer::tables::LearnerTable;

/// Standard deviations by which a way must have changed.
const SURE: i32 = 4;

/// Where the teeth rested last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anchor<T: Real, const P: usize> {
    /// What the way depended on; the side among it is 1, -1, or 0 for unknown.
    then: Regressors<T, P>,
    way: T,
    ride: Ride<T>,
    held: bool,
    /// Nothing has interrupted the rest since.
    goes_on: bool,
}

impl<T: Real, const P: usize> Anchor<T, P> {
    pub fn new() -> Self {
        Self { then: [T::ZERO; P], way: T::ZERO, ride: Ride::NONE, held: false, goes_on: false }
    }

    /// Remembers a rest.
    pub fn put(&mut self, regressors: &Regressors<T, P>, way: T, side: T) {
        *self = Self { then: *regressors, way, ride: self.ride, held: true, goes_on: true };
        if let Some(half_gap) = self.then.get_mut(HALF_GAP) {
            *half_gap = side;
        }
    }

    /// The teeth are not at rest.
    pub fn interrupt(&mut self) {
        self.goes_on = false;
    }

    /// What is known of the rest without a force.
    pub fn ride(&mut self) -> &mut Ride<T> {
        &mut self.ride
    }

    /// Whether the teeth rested on a side last.
    pub fn was_on(&self, side: T) -> bool {
        self.then.get(HALF_GAP) == Some(&side)
    }

    /// By how much the way of another rest is beyond what the last one's would be there; `None` if there was none. Teeth
    /// that stay on a flank, whichever it is, show by that what the way depends on besides.
    pub fn weigh(
        &self,
        table: &LearnerTable<T>,
        learner: &Learner<T, P>,
        regressors: &Regressors<T, P>,
        way: T,
    ) -> Option<Weighed<T, P>> {
        let between: Regressors<T, P> = array::from_fn(|i| match (regressors.get(i), self.then.get(i)) {
            (Some(now), Some(before)) if i != HALF_GAP => *now - *before,
            _ => T::ZERO,
        });
        // Either way has its noise.
        self.held.then(|| learner.weigh(table, &between, way - self.way, table.weight * T::HALF.square_root()))
    }

    /// The side of that rest; 0 if the change is neither more than everything else could make of it, nor so little
    /// that it is the same flank. While the link hardly moves, nothing is said: motor and link may rest with open teeth.
    pub fn side(
        &mut self,
        table: &LearnerTable<T>,
        weighed: &Weighed<T, P>,
        regressors: &Regressors<T, P>,
        half_gap: T,
        lever: T,
    ) -> T {
        let speed = regressors.get(SKEW).copied().unwrap_or(T::ZERO);
        let went = speed * lever * table.span * T::from_i32(table.block as i32);
        let noise = table.noise * T::TWO.square_root();
        let moved = weighed.surprise * noise;
        let sure = T::from_i32(SURE * SURE) * weighed.expected * noise * noise;
        let wide = self.ride.half_gap_at_least(half_gap);
        let change = if moved * moved >= sure {
            if magnitude(moved) > half_gap * T::HALF { Change::Crossed } else { Change::Unsure }
        } else if sure < wide * wide {
            Change::Stays
        } else {
            Change::Hidden
        };
        let moves = magnitude(went) >= half_gap;
        self.ride.step(change, moved, went, self.goes_on, moves);
        match change {
            _ if !moves => T::ZERO,
            Change::Crossed if moved > T::ZERO => T::ONE,
            Change::Crossed => -T::ONE,
            Change::Stays => self.then.get(HALF_GAP).copied().unwrap_or(T::ZERO),
            Change::Unsure | Change::Hidden => T::ZERO,
        }
    }
}

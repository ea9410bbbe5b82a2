//! On which flank teeth came to rest, by how the deflection has changed since they rested last: upwards is the drive
//! flank, whatever force and bias are.

use core::array;

use super::co_motion::{Change, CoMotion};
use super::learner::{Innovation, Learner};
use super::regressors::{HALF_GAP, Regressors, SKEW};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::LearnerTable;

/// Standard deviations by which a deflection must have changed for teeth to have crossed the gap: one rest in 16,000 shows
/// that by noise.
const SURE: i32 = 4;

/// Where the teeth rested last.
#[derive(Debug, Clone, Copy)]
pub struct LastRest<T: Real, const P: usize> {
    /// What the deflection depended on, but the flank.
    then: Regressors<T, P>,
    flank: Option<Flank>,
    deflection: T,
    co_motion: CoMotion<T>,
    held: bool,
    /// Nothing has interrupted the rest since.
    goes_on: bool,
}

impl<T: Real, const P: usize> LastRest<T, P> {
    /// A constant, so that the compiler writes it to its place instead of copying one from the stack.
    const NEW: Self = Self {
        then: [T::ZERO; P],
        flank: None,
        deflection: T::ZERO,
        co_motion: CoMotion::NONE,
        held: false,
        goes_on: false,
    };

    #[inline(always)]
    pub fn new() -> Self {
        Self::NEW
    }

    /// Remembers a rest.
    pub fn put(&mut self, regressors: &Regressors<T, P>, deflection: T, flank: Option<Flank>) {
        *self = Self { then: *regressors, flank, deflection, co_motion: self.co_motion, held: true, goes_on: true };
    }

    /// The teeth are not at rest.
    pub fn interrupt(&mut self) {
        self.goes_on = false;
    }

    /// What is known of the rest without a force.
    pub fn co_motion(&mut self) -> &mut CoMotion<T> {
        &mut self.co_motion
    }

    /// Whether the teeth rested on a flank last; with `None`, on one that was not known.
    pub fn was_on(&self, flank: Option<Flank>) -> bool {
        self.flank == flank
    }

    /// The innovation of another rest, whose prediction is the last one's deflection; `None` if there was none. Teeth that
    /// stay on a flank, whichever it is, show by that what the deflection depends on besides.
    pub fn innovation(
        &self,
        table: &LearnerTable<T>,
        learner: &Learner<T, P>,
        regressors: &Regressors<T, P>,
        deflection: T,
    ) -> Option<Innovation<T, P>> {
        let between: Regressors<T, P> = array::from_fn(|i| match (regressors.get(i), self.then.get(i)) {
            (Some(now), Some(before)) if i != HALF_GAP => *now - *before,
            _ => T::ZERO,
        });
        // Both deflections have their noise.
        let weight = table.weight * T::HALF.square_root();
        self.held.then(|| learner.innovation(table, &between, deflection - self.deflection, weight))
    }

    /// The flank of that rest; `None` if the change is neither more than everything else could make of it, nor so little
    /// that it is the same flank. While the link hardly moves, nothing is said: motor and link may rest with open teeth.
    pub fn flank(
        &mut self,
        table: &LearnerTable<T>,
        innovation: &Innovation<T, P>,
        regressors: &Regressors<T, P>,
        half_gap: T,
        lever: T,
    ) -> Option<Flank> {
        let speed = regressors.get(SKEW).copied().unwrap_or(T::ZERO);
        let went = speed * lever * table.span * T::from_i32(table.block as i32);
        let noise = table.noise * T::TWO.square_root();
        let moved = innovation.value * noise;
        let sure = T::from_i32(SURE * SURE) * innovation.variance * noise * noise;
        let wide = self.co_motion.half_gap_at_least(half_gap);
        let change = if moved * moved >= sure {
            if moved.abs() > half_gap * T::HALF { Change::Crossed } else { Change::Unsure }
        } else if sure < wide * wide {
            Change::Stays
        } else {
            Change::Hidden
        };
        let moves = went.abs() >= half_gap;
        self.co_motion.step(change, moved, went, self.goes_on, moves);
        match change {
            _ if !moves => None,
            Change::Crossed => Some(if moved > T::ZERO { Flank::Drive } else { Flank::Back }),
            Change::Stays => self.flank,
            Change::Unsure | Change::Hidden => None,
        }
    }
}

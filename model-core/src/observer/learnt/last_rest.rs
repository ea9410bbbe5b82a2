//! Flank of a rest from the change of the deflection since the last rest: an upward change means the drive flank,
//! regardless of force and bias.

use core::array;

use super::co_motion::{Change, CoMotion};
use super::learner::{Innovation, Learner};
use super::regressors::{HALF_GAP, Regressors, SKEW};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::LearnerTable;

/// Change of the deflection that proves a crossing [standard deviations]: noise causes one in 16,000 rests to exceed
/// this limit.
const SURE: i32 = 4;

/// Last rest of the teeth.
#[derive(Debug, Clone, Copy)]
pub struct LastRest<T: Real, const P: usize> {
    /// Regressors of the last rest.
    then: Regressors<T, P>,
    flank: Option<Flank>,
    deflection: T,
    co_motion: CoMotion<T>,
    held: bool,
    /// True until the rest is interrupted.
    goes_on: bool,
}

impl<T: Real, const P: usize> LastRest<T, P> {
    /// A constant: the compiler writes it in place instead of copying from the stack.
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

    /// Stores a rest.
    pub fn put(&mut self, regressors: &Regressors<T, P>, deflection: T, flank: Option<Flank>) {
        *self = Self { then: *regressors, flank, deflection, co_motion: self.co_motion, held: true, goes_on: true };
    }

    /// Notes that the teeth are not at rest.
    pub fn interrupt(&mut self) {
        self.goes_on = false;
    }

    /// Evidence on the flank without a force.
    pub fn co_motion(&mut self) -> &mut CoMotion<T> {
        &mut self.co_motion
    }

    /// Returns true if the last rest was on this flank; `None` stands for an unknown flank.
    pub fn was_on(&self, flank: Option<Flank>) -> bool {
        self.flank == flank
    }

    /// Innovation of a rest predicted from the last rest's deflection; `None` without a last rest. Teeth that stay on
    /// one flank, even an unknown one, show the parameters that do not depend on the flank.
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
        // Both deflections carry noise.
        let weight = table.weight * T::HALF.square_root();
        self.held.then(|| learner.innovation(table, &between, deflection - self.deflection, weight))
    }

    /// Flank of the new rest; `None` if the change is neither larger than all other influences nor small enough for the
    /// same flank. While the link hardly moves, the flank stays unknown: motor and link may rest with open teeth.
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

//! Flank of a dwell from the change of the deflection since the last dwell: an upward change means the drive flank,
//! regardless of force and bias.

use super::thresholds::FLANK;
use core::array;

use super::co_motion::{CoMotion, DeflectionChange};
use super::least_squares::{Innovation, LeastSquares};
use super::regressors::{HALF_GAP, Regressors, SKEW};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::LearnerTable;

/// Last dwell of the teeth.
#[derive(Debug, Clone, Copy)]
pub struct LastDwell<T: Real, const P: usize> {
    /// Regressors of the last dwell.
    regressors: Regressors<T, P>,
    flank: Option<Flank>,
    deflection: T,
    co_motion: CoMotion<T>,
    is_stored: bool,
    /// True until the dwell is interrupted.
    is_continuous: bool,
}
state_words! { struct LastDwell<T, P> { regressors, flank, deflection, co_motion, is_stored, is_continuous } }

impl<T: Real, const P: usize> LastDwell<T, P> {
    /// A constant: the compiler writes it in place instead of copying from the stack.
    pub const NEW: Self = Self {
        regressors: [T::ZERO; P],
        flank: None,
        deflection: T::ZERO,
        co_motion: CoMotion::NONE,
        is_stored: false,
        is_continuous: false,
    };

    /// Stores a dwell.
    pub fn store(&mut self, regressors: &Regressors<T, P>, deflection: T, flank: Option<Flank>) {
        *self = Self {
            regressors: *regressors,
            flank,
            deflection,
            co_motion: self.co_motion,
            is_stored: true,
            is_continuous: true,
        };
    }

    /// Notes that the teeth are not at rest.
    pub fn interrupt(&mut self) {
        self.is_continuous = false;
    }

    /// Evidence on the flank without a force.
    pub fn co_motion(&mut self) -> &mut CoMotion<T> {
        &mut self.co_motion
    }

    /// Returns true if the last dwell was on this flank; `None` stands for an unknown flank.
    pub fn was_on(&self, flank: Option<Flank>) -> bool {
        self.flank == flank
    }

    /// Innovation of a dwell predicted from the last dwell's deflection; `None` without a last dwell. Teeth that stay
    /// on one flank, even an unknown one, show the parameters that do not depend on the flank.
    pub fn innovation(
        &self,
        table: &LearnerTable<T>,
        least_squares: &LeastSquares<T, P>,
        regressors: &Regressors<T, P>,
        deflection: T,
    ) -> Option<Innovation<T, P>> {
        let between: Regressors<T, P> = array::from_fn(|i| match (regressors.get(i), self.regressors.get(i)) {
            (Some(now), Some(before)) if i != HALF_GAP => *now - *before,
            _ => T::ZERO,
        });
        // Both deflections carry noise.
        let weight = table.weight * T::HALF.square_root();
        self.is_stored.then(|| least_squares.innovation(table, &between, deflection - self.deflection, weight))
    }

    /// Flank of the new dwell; `None` if the change is neither larger than all other influences nor small enough for
    /// the same flank. While the link hardly moves, the flank stays unknown: motor and link may rest with open teeth.
    pub fn flank(
        &mut self,
        table: &LearnerTable<T>,
        innovation: &Innovation<T, P>,
        regressors: &Regressors<T, P>,
        half_gap: T,
        lever: T,
    ) -> Option<Flank> {
        let speed = regressors.get(SKEW).copied().unwrap_or(T::ZERO);
        let link_travel = speed * lever * table.span * T::from_i32(table.block as i32);
        let noise = table.noise * T::TWO.square_root();
        let change_of_deflection = innovation.value * noise;
        let crossing_square =
            T::from_i32(FLANK.crossing_sigma * FLANK.crossing_sigma) * innovation.variance * noise * noise;
        let half_gap_bound = self.co_motion.half_gap_at_least(half_gap);
        let change = if change_of_deflection * change_of_deflection >= crossing_square {
            if change_of_deflection.abs() > half_gap * T::HALF {
                DeflectionChange::Crossed
            } else {
                DeflectionChange::Unsure
            }
        } else if crossing_square < half_gap_bound * half_gap_bound {
            DeflectionChange::Stays
        } else {
            DeflectionChange::Hidden
        };
        let link_moves = link_travel.abs() >= half_gap;
        self.co_motion.step(change, change_of_deflection, link_travel, self.is_continuous, link_moves);
        match change {
            _ if !link_moves => None,
            DeflectionChange::Crossed => Some(if change_of_deflection > T::ZERO { Flank::Drive } else { Flank::Back }),
            DeflectionChange::Stays => self.flank,
            DeflectionChange::Unsure | DeflectionChange::Hidden => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::regressors::{OFFSET, PLAIN};
    use super::*;
    use crate::observer::test_tables::learner;

    #[test]
    fn crossing_needs_four_deviations() {
        let flank = |change: f32| {
            // No parameter is uncertain. The link moves by 10 um in 8 intervals of 1 ms.
            let (least_squares, mut last) = (LeastSquares::<f32, PLAIN>::UNINITIALIZED, LastDwell::NEW);
            let mut regressors = [0.0; PLAIN];
            (regressors[OFFSET], regressors[SKEW]) = (1.0, 1.25e-3);
            last.store(&regressors, 0.0, Some(Flank::Back));
            let innovation = last.innovation(&learner(), &least_squares, &regressors, change).expect("a last dwell");
            last.flank(&learner(), &innovation, &regressors, 8e-6, 1.0)
        };
        // Two deflections with a noise of 1 um each: 4 sqrt(2) um, above half of the half-gap of 8 um.
        assert_eq!((flank(5.5e-6), flank(5.8e-6)), (Some(Flank::Back), Some(Flank::Drive)));
    }
}

//! Intervals of settled contact put together into one way to learn from. When contact is settled is left to `interval`.

use super::learner::Regressors;
use super::regressors::Touch;
use crate::real::Real;
use crate::tables::observer::LearnerTable;

/// What an interval adds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settled<'mean, T: Real, const P: usize> {
    /// What the way depends on, teeth left out.
    pub free: &'mean Regressors<T, P>,
    /// Sine and cosine of the mesh phase.
    pub mesh: &'mean [T; 2],
    /// Way as measured [m].
    pub raw: T,
    /// Mesh force [N].
    pub force: T,
}

/// Intervals of settled contact in a row, gathered into one way to learn from: noise of the mesh force that is left in
/// a regressor would make the compliance look smaller than it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<T: Real, const P: usize> {
    intervals: u32,
    touch: Touch<T>,
    free: Regressors<T, P>,
    raw: T,
}

impl<T: Real, const P: usize> Block<T, P> {
    pub fn new() -> Self {
        Self { intervals: 0, touch: Touch::default(), free: [T::ZERO; P], raw: T::ZERO }
    }

    /// Adds an interval; gives regressors and way when enough have passed on one side.
    pub fn add(
        &mut self,
        mean: &Settled<'_, T, P>,
        side: Option<T>,
        table: &LearnerTable<T>,
    ) -> Option<(Regressors<T, P>, T)> {
        let Some(side) = side else {
            *self = Self::new();
            return None;
        };
        if side != self.touch.side {
            *self = Self::new();
            self.touch.side = side;
        }
        let free = self.free.iter_mut().zip(mean.free);
        for (sum, value) in free.chain(self.touch.mesh.iter_mut().zip(mean.mesh)) {
            *sum += *value * table.per_block;
        }
        self.raw += mean.raw * table.per_block;
        self.touch.force += mean.force * table.per_block;
        self.intervals += 1;
        if self.intervals < table.block {
            return None;
        }
        let full = (self.touch.on(&self.free), self.raw);
        *self = Self::new();
        self.touch.side = side;
        Some(full)
    }
}

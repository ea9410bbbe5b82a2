//! Intervals of settled contact put together into one way to learn from. When contact is settled is left to `interval`.

use super::regressors::{Regressors, Touch};
use crate::numbers::Real;
use crate::observer::tables::LearnerTable;

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
    intervals: u8,
    /// Intervals of which the means are, where a touch ended early; else 0.
    brief: u8,
    /// Blocks on the back side and on the drive side that their forces are taken over.
    taken: [u8; 2],
    touch: Touch<T>,
    free: Regressors<T, P>,
    raw: T,
    /// Forces on the back side, then on the drive side.
    forces: [Forces<T>; 2],
}

/// Blocks over which the mean of a force is taken: about half a second of contact.
const FORCES: u8 = 64;

/// Forces of the last blocks on one side.
#[derive(Debug, Clone, Copy)]
struct Forces<T: Real> {
    /// [N].
    mean: T,
    /// [N^2].
    variance: T,
}

impl<T: Real> Forces<T> {
    const NONE: Self = Self { mean: T::ZERO, variance: T::ZERO };

    /// Takes in a block's force; gives what it most likely was. Its noise would pass for force that the way does not
    /// follow, hence for a stiffer joint: what varies no more than noise does is taken for constant.
    fn calibrated(&mut self, blocks: u8, force: T, noise: T) -> T {
        let share = T::ONE.over(T::from_i32(blocks.into()));
        let by = force - self.mean;
        self.mean += by * share;
        let beyond = force - self.mean;
        self.variance += (by * beyond - self.variance) * share;
        if self.variance > noise { self.mean + beyond * (T::ONE - noise.over(self.variance)) } else { self.mean }
    }
}

impl<T: Real, const P: usize> Block<T, P> {
    pub fn new() -> Self {
        Self {
            intervals: 0,
            brief: 0,
            taken: [0; 2],
            touch: Touch::default(),
            free: [T::ZERO; P],
            raw: T::ZERO,
            forces: [Forces::NONE; 2],
        }
    }

    /// Begins anew on a side.
    fn clear(&mut self, side: T) {
        *self =
            Self { taken: self.taken, forces: self.forces, touch: Touch { side, ..Touch::default() }, ..Self::new() };
    }

    /// Sums of fewer intervals become means.
    fn stretch(&mut self, by: T) {
        let free = self.free.iter_mut().chain(&mut self.touch.mesh);
        free.chain([&mut self.raw, &mut self.touch.force]).for_each(|sum| *sum *= by);
    }

    /// Adds an interval; true when enough have passed on one side, or at least so many and the touch has ended.
    pub fn add(&mut self, mean: &Settled<'_, T, P>, side: Option<T>, least: u8, table: &LearnerTable<T>) -> bool {
        let full = table.block as u8;
        let Some(side) = side else {
            if (least..full).contains(&self.intervals) && self.touch.side != T::ZERO {
                self.brief = self.intervals;
                self.stretch(T::from_i32(full.into()).over(T::from_i32(self.brief.into())));
                self.intervals = full;
                return true;
            }
            self.clear(T::ZERO);
            return false;
        };
        // One rest is on one flank, even while no force tells which.
        let told = if side == T::ZERO { self.touch.side } else { side };
        let other = told != self.touch.side && self.touch.side != T::ZERO;
        if other || self.intervals >= full {
            self.clear(told);
        }
        self.touch.side = told;
        let free = self.free.iter_mut().zip(mean.free);
        for (sum, value) in free.chain(self.touch.mesh.iter_mut().zip(mean.mesh)) {
            *sum += *value * table.per_block;
        }
        self.raw += mean.raw * table.per_block;
        self.touch.force += mean.force * table.per_block;
        self.intervals += 1;
        if u32::from(self.intervals) < table.block {
            return false;
        }
        let index = usize::from(told > T::ZERO);
        if let (Some(forces), Some(taken)) = (self.forces.get_mut(index), self.taken.get_mut(index)) {
            *taken = (*taken + 1).min(FORCES);
            self.touch.force = forces.calibrated(*taken, self.touch.force, table.force_noise);
        }
        true
    }

    /// Regressors and way of a full one.
    pub fn full(&self) -> (Regressors<T, P>, T) {
        (self.touch.on(&self.free), self.raw)
    }

    /// Part of a way's usual weight that a full one has. The means of a touch that ended early are noisier, and teeth that
    /// leave or land are not at rest; while the `width_is_known` not, it may have been no touch at all.
    pub fn worth(&self, table: &LearnerTable<T>, width_is_known: bool) -> T {
        if self.brief == 0 {
            T::ONE
        } else if width_is_known {
            T::HALF * (T::from_i32(self.brief.into()) * table.per_block).square_root()
        } else {
            T::QUARTER
        }
    }

    /// Side of a full one; 0 for unknown.
    pub fn side(&self) -> T {
        self.touch.side
    }

    /// Tells the side of a full one.
    pub fn tell(&mut self, side: T) {
        self.touch.side = side;
    }
}

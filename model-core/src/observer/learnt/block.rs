//! Learning intervals of settled contact averaged into one deflection to learn from.

use super::interval::Rest;
use super::regressors::{Regressors, Touch};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::LearnerTable;

/// What an interval adds.
#[derive(Debug, Clone, Copy)]
pub struct Settled<'mean, T: Real, const P: usize> {
    /// What the deflection depends on, teeth left out.
    pub free: &'mean Regressors<T, P>,
    /// Sine and cosine of the mesh phase.
    pub mesh: &'mean [T; 2],
    /// Deflection as measured [m].
    pub measured: T,
    /// Mesh force [N].
    pub force: T,
}

/// Intervals of settled contact in a row, averaged into one deflection to learn from: noise of the mesh force that is left
/// in a regressor would make the compliance look smaller than it is.
#[derive(Debug, Clone, Copy)]
pub struct Block<T: Real, const P: usize> {
    intervals: u8,
    /// Intervals of which the means are, where a touch ended early; else 0.
    brief: u8,
    /// Blocks on the drive flank and on the back flank that their forces are averaged over.
    averaged: [u8; 2],
    touch: Touch<T>,
    free: Regressors<T, P>,
    deflection: T,
    /// Forces on the drive flank, then on the back flank.
    forces: [Forces<T>; 2],
}

/// Blocks over which the mean of a force is taken: about half a second of contact.
const FORCES: u8 = 64;

/// Forces of the last blocks on one flank.
#[derive(Debug, Clone, Copy)]
struct Forces<T: Real> {
    /// [N].
    mean: T,
    /// [N^2].
    variance: T,
}

impl<T: Real> Forces<T> {
    const NONE: Self = Self { mean: T::ZERO, variance: T::ZERO };

    /// Takes in a block's force; gives what it most likely was. Its noise would pass for force that the deflection does
    /// not follow, hence for a stiffer joint: what varies no more than noise does is taken for constant.
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
    /// Weight of a touch that ended early while the half-gap is not known [-]: it may have been no touch at all, and sixteen
    /// of them count as one rest.
    const UNSURE_TOUCH: T = T::QUARTER;

    /// A constant, so that the compiler writes it to its place instead of copying one from the stack.
    const NEW: Self = Self {
        intervals: 0,
        brief: 0,
        averaged: [0; 2],
        touch: Touch::NONE,
        free: [T::ZERO; P],
        deflection: T::ZERO,
        forces: [Forces::NONE; 2],
    };

    #[inline(always)]
    pub fn new() -> Self {
        Self::NEW
    }

    /// Begins anew on a flank.
    fn clear(&mut self, flank: Option<Flank>) {
        let touch = Touch { flank, ..Touch::NONE };
        *self = Self { averaged: self.averaged, forces: self.forces, touch, ..Self::new() };
    }

    /// Sums of fewer intervals become means.
    fn scale(&mut self, by: T) {
        let free = self.free.iter_mut().chain(&mut self.touch.mesh);
        free.chain([&mut self.deflection, &mut self.touch.force]).for_each(|sum| *sum *= by);
    }

    /// Adds an interval; true when enough have passed on one flank, or at least so many and the touch has ended.
    pub fn add(&mut self, mean: &Settled<'_, T, P>, rest: Rest, least: u8, table: &LearnerTable<T>) -> bool {
        let full = table.block as u8;
        let Rest::On(flank) = rest else {
            if (least..full).contains(&self.intervals) && self.touch.flank.is_some() {
                self.brief = self.intervals;
                self.scale(T::from_i32(full.into()).over(T::from_i32(self.brief.into())));
                self.intervals = full;
                return true;
            }
            self.clear(None);
            return false;
        };
        // One rest is on one flank, even while no force tells which.
        let told = flank.or(self.touch.flank);
        let other = told != self.touch.flank && self.touch.flank.is_some();
        if other || self.intervals >= full {
            self.clear(told);
        }
        self.touch.flank = told;
        let free = self.free.iter_mut().zip(mean.free);
        for (sum, value) in free.chain(self.touch.mesh.iter_mut().zip(mean.mesh)) {
            *sum += *value * table.per_block;
        }
        self.deflection += mean.measured * table.per_block;
        self.touch.force += mean.force * table.per_block;
        self.intervals += 1;
        if u32::from(self.intervals) < table.block {
            return false;
        }
        let [drive, back] = &mut self.forces;
        let [blocks_drive, blocks_back] = &mut self.averaged;
        let drives = told == Some(Flank::Drive);
        let (forces, blocks) = if drives { (drive, blocks_drive) } else { (back, blocks_back) };
        *blocks = (*blocks + 1).min(FORCES);
        self.touch.force = forces.calibrated(*blocks, self.touch.force, table.force_noise);
        true
    }

    /// Regressors and deflection [m] of a full one.
    pub fn full(&self) -> (Regressors<T, P>, T) {
        (self.touch.on(&self.free), self.deflection)
    }

    /// Part of a deflection's usual weight that a full one has [-]. The means of a touch that ended early are noisier, and teeth that
    /// leave or land are not at rest; while the `half_gap_is_known` not, it may have been no touch at all.
    pub fn worth(&self, table: &LearnerTable<T>, half_gap_is_known: bool) -> T {
        if self.brief == 0 {
            T::ONE
        } else if half_gap_is_known {
            T::HALF * (T::from_i32(self.brief.into()) * table.per_block).square_root()
        } else {
            Self::UNSURE_TOUCH
        }
    }

    /// Flank of a full one; `None` if it is not known.
    pub fn flank(&self) -> Option<Flank> {
        self.touch.flank
    }

    /// Tells the flank of a full one.
    pub fn tell(&mut self, flank: Option<Flank>) {
        self.touch.flank = flank;
    }
}

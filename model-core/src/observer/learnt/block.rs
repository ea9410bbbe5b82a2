//! Averages of learning intervals in settled contact (O15), each a measurement of the deflection.

use super::interval::Rest;
use super::regressors::{Regressors, Touch};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::LearnerTable;

/// Contribution of an interval.
#[derive(Debug, Clone, Copy)]
pub struct Settled<'mean, T: Real, const P: usize> {
    /// Regressors of an open gap.
    pub free: &'mean Regressors<T, P>,
    /// Sine and cosine of the mesh phase.
    pub mesh: &'mean [T; 2],
    /// Measured deflection [m].
    pub measured: T,
    /// Mesh force [N].
    pub force: T,
}

/// Consecutive intervals of settled contact, averaged into one measurement of the deflection. Noise of the mesh force
/// in the regressor would bias the compliance low.
#[derive(Debug, Clone, Copy)]
pub struct Block<T: Real, const P: usize> {
    intervals: u8,
    /// Averaged intervals of a touch that ended early, otherwise 0.
    brief: u8,
    /// Blocks in the mean force on the drive flank and on the back flank.
    averaged: [u8; 2],
    touch: Touch<T>,
    free: Regressors<T, P>,
    deflection: T,
    /// Forces on the drive flank, then on the back flank.
    forces: [Forces<T>; 2],
}

/// Blocks over which the mean force is taken: about half a second of contact.
const FORCES: u8 = 64;

/// Forces of the last blocks on one flank.
#[derive(Debug, Clone, Copy)]
struct Forces<T: Real> {
    /// Mean [N].
    mean: T,
    /// Variance [N^2].
    variance: T,
}

impl<T: Real> Forces<T> {
    const NONE: Self = Self { mean: T::ZERO, variance: T::ZERO };

    /// Updates mean and variance with a block's force and returns the likeliest force (O15). Noise would count as force
    /// that the deflection does not follow, hence as stiffness: a variation no larger than the noise is treated as
    /// constant force.
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
    /// Weight of a touch that ended early while the half-gap is unknown [-]: the teeth may not have touched, so that
    /// sixteen of these touches count as one rest.
    const UNSURE_TOUCH: T = T::QUARTER;

    /// A constant: the compiler writes it in place instead of copying from the stack.
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

    /// Begins a new block on a flank.
    fn clear(&mut self, flank: Option<Flank>) {
        let touch = Touch { flank, ..Touch::NONE };
        *self = Self { averaged: self.averaged, forces: self.forces, touch, ..Self::new() };
    }

    /// Multiplies all sums by a factor, which turns sums of fewer intervals into means.
    fn scale(&mut self, by: T) {
        let free = self.free.iter_mut().chain(&mut self.touch.mesh);
        free.chain([&mut self.deflection, &mut self.touch.force]).for_each(|sum| *sum *= by);
    }

    /// Adds an interval. Returns true once a block is full, or once a touch on a known flank has ended after at least
    /// `least` intervals.
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
        // A rest stays on one flank, even while no force shows the flank.
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

    /// Regressors and deflection [m] of a full block.
    pub fn full(&self) -> (Regressors<T, P>, T) {
        (self.touch.on(&self.free), self.deflection)
    }

    /// Weight of a full block relative to a usual deflection [-]. A touch that ended early is averaged less, and teeth
    /// that leave or land are not at rest; while the half-gap is unknown, the teeth may not have touched.
    pub fn worth(&self, table: &LearnerTable<T>, half_gap_is_known: bool) -> T {
        if self.brief == 0 {
            T::ONE
        } else if half_gap_is_known {
            T::HALF * (T::from_i32(self.brief.into()) * table.per_block).square_root()
        } else {
            Self::UNSURE_TOUCH
        }
    }

    /// Flank of a full block; `None` if unknown.
    pub fn flank(&self) -> Option<Flank> {
        self.touch.flank
    }

    /// Sets the flank of a full block.
    pub fn tell(&mut self, flank: Option<Flank>) {
        self.touch.flank = flank;
    }
}

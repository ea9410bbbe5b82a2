//! Averages of learning intervals on a flank, each a measurement of the deflection with the likeliest force:
//!
//! ```text
//! (O15) F_k = mean + (F_h - mean) max(0, 1 - var(noise)/var(F_h))
//! ```
//!
//! Symbols: F_h = `force`, mean = `ForceStatistics::mean`, var(F_h) = `ForceStatistics::variance`, var(noise) =
//! `force_noise`.

use super::interval::Dwell;
use super::regressors::{ContactSample, Regressors};
use super::thresholds::EstimatorThresholds;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::LearnerTable;

/// Contribution of an interval.
#[derive(Debug, Clone, Copy)]
pub struct IntervalSample<'mean, T: Real, const P: usize> {
    /// Regressors of an open gap.
    pub open_gap: &'mean Regressors<T, P>,
    /// Sine and cosine of the mesh phase.
    pub mesh: &'mean [T; 2],
    /// Measured deflection [m].
    pub raw_deflection: T,
    /// Mesh force [N].
    pub force: T,
}

/// Consecutive intervals of settled contact, averaged into one measurement of the deflection. Noise of the mesh force
/// in the regressor would bias the compliance low.
#[derive(Debug, Clone, Copy)]
pub struct Batch<T: Real, const P: usize> {
    intervals: u8,
    /// Averaged intervals of a contact that ended early, otherwise 0.
    contact_intervals: u8,
    /// Batches in the mean force on the drive flank and on the back flank.
    batches: [u8; 2],
    contact: ContactSample<T>,
    open_gap: Regressors<T, P>,
    deflection: T,
    /// Forces on the drive flank, then on the back flank.
    forces: [ForceStatistics<T>; 2],
}
state_words! {
    struct Batch<T, P> {
        intervals, contact_intervals, batches, contact, open_gap, deflection, forces,
    }
}

/// Forces of the last batches on one flank.
#[derive(Debug, Clone, Copy)]
struct ForceStatistics<T: Real> {
    /// Mean [N].
    mean: T,
    /// Variance [N^2].
    variance: T,
}
state_words! { struct ForceStatistics<T> { mean, variance } }

impl<T: Real> ForceStatistics<T> {
    const NONE: Self = Self { mean: T::ZERO, variance: T::ZERO };

    /// Updates mean and variance with a batch's force and returns the likeliest force (O15). Noise would count as force
    /// that the deflection does not follow, hence as stiffness: a variation no larger than the noise is treated as
    /// constant force.
    fn update(&mut self, count: u8, force: T, noise: T) -> T {
        let share = T::ONE / T::from_i32(count.into());
        let change = force - self.mean;
        self.mean += change * share;
        let excess = force - self.mean;
        self.variance += (change * excess - self.variance) * share;
        if self.variance > noise { self.mean + excess * (T::ONE - noise / self.variance) } else { self.mean }
    }
}

impl<T: Real, const P: usize> Batch<T, P> {
    const LIMITS: EstimatorThresholds<T> = EstimatorThresholds::TUNED;

    /// A constant: the compiler writes it in place instead of copying from the stack.
    pub const NEW: Self = Self {
        intervals: 0,
        contact_intervals: 0,
        batches: [0; 2],
        contact: ContactSample::OPEN,
        open_gap: [T::ZERO; P],
        deflection: T::ZERO,
        forces: [ForceStatistics::NONE; 2],
    };

    /// Begins a new batch on a flank.
    fn begin_on(&mut self, flank: Option<Flank>) {
        let contact = ContactSample { flank, ..ContactSample::OPEN };
        *self = Self { batches: self.batches, forces: self.forces, contact, ..Self::NEW };
    }

    /// Multiplies all sums by a factor, which turns sums of fewer intervals into means.
    fn scale(&mut self, by: T) {
        let free = self.open_gap.iter_mut().chain(&mut self.contact.mesh);
        free.chain([&mut self.deflection, &mut self.contact.force]).for_each(|sum| *sum *= by);
    }

    /// Adds an interval. Returns true once a batch is full, or once a contact on a known flank has ended after at least
    /// `shortest` intervals.
    pub fn add(
        &mut self,
        mean: &IntervalSample<'_, T, P>,
        dwell: Dwell,
        shortest: u8,
        table: &LearnerTable<T>,
    ) -> bool {
        let length = table.block as u8;
        let Dwell::On(flank) = dwell else {
            if (shortest..length).contains(&self.intervals) && self.contact.flank.is_some() {
                self.contact_intervals = self.intervals;
                self.scale(T::from_i32(length.into()) / T::from_i32(self.contact_intervals.into()));
                self.intervals = length;
                return true;
            }
            self.begin_on(None);
            return false;
        };
        // The flank of a dwell does not change: while the force shows no flank, the flank of the batch is kept.
        let known_flank = flank.or(self.contact.flank);
        let is_other_flank = known_flank != self.contact.flank && self.contact.flank.is_some();
        if is_other_flank || self.intervals >= length {
            self.begin_on(known_flank);
        }
        self.contact.flank = known_flank;
        let free = self.open_gap.iter_mut().zip(mean.open_gap);
        for (sum, value) in free.chain(self.contact.mesh.iter_mut().zip(mean.mesh)) {
            *sum += *value * table.per_block;
        }
        self.deflection += mean.raw_deflection * table.per_block;
        self.contact.force += mean.force * table.per_block;
        self.intervals += 1;
        if u32::from(self.intervals) < table.block {
            return false;
        }
        let [drive, back] = &mut self.forces;
        let [batches_drive, batches_back] = &mut self.batches;
        let is_drive_flank = known_flank == Some(Flank::Drive);
        let (forces, count) = if is_drive_flank { (drive, batches_drive) } else { (back, batches_back) };
        *count = (*count + 1).min(Self::LIMITS.force_batches);
        self.contact.force = forces.update(*count, self.contact.force, table.force_noise);
        true
    }

    /// Regressors and deflection [m] of a full batch.
    pub fn measurement(&self) -> (Regressors<T, P>, T) {
        (self.contact.add_to(&self.open_gap), self.deflection)
    }

    /// Weight of a full batch relative to a usual deflection [-]. A contact that ended early is averaged less, and
    /// teeth that leave or land are not at rest; while the half-gap is unknown, the teeth may not have touched.
    pub fn relative_weight(&self, table: &LearnerTable<T>, half_gap_is_known: bool) -> T {
        if self.contact_intervals == 0 {
            T::ONE
        } else if half_gap_is_known {
            T::HALF * (T::from_i32(self.contact_intervals.into()) * table.per_block).square_root()
        } else {
            Self::LIMITS.unsure_contact_weight
        }
    }

    /// Flank of a full batch; `None` if unknown.
    pub fn flank(&self) -> Option<Flank> {
        self.contact.flank
    }

    /// Sets the flank of a full batch.
    pub fn set_flank(&mut self, flank: Option<Flank>) {
        self.contact.flank = flank;
    }
}

#[cfg(test)]
mod tests {
    use super::super::regressors::PLAIN;
    use super::*;
    use crate::observer::test_tables::learner;

    const DRIVE: Option<Flank> = Some(Flank::Drive);

    /// Adds an interval with a deflection and a force.
    fn add(batch: &mut Batch<f32, PLAIN>, dwell: Dwell, deflection: f32, force: f32) -> bool {
        let (open_gap, mesh) = ([0.0; PLAIN], [0.0, 1.0]);
        let sample = IntervalSample { open_gap: &open_gap, mesh: &mesh, raw_deflection: deflection, force };
        batch.add(&sample, dwell, 2, &learner())
    }

    /// Adds `intervals` on the drive flank.
    fn fill(batch: &mut Batch<f32, PLAIN>, intervals: u8) -> bool {
        (0..intervals).fold(false, |_, _| add(batch, Dwell::On(DRIVE), 4.0, 10.0))
    }

    #[test]
    fn full_batch_is_mean() {
        let mut batch = Batch::NEW;
        assert!(!fill(&mut batch, 7));
        assert!(add(&mut batch, Dwell::On(DRIVE), 12.0, 10.0));
        let (regressors, deflection) = batch.measurement();
        assert_eq!((deflection, regressors[0], regressors[2]), (5.0, 1.0, 10.0));
        assert_eq!(batch.relative_weight(&learner(), true), 1.0);
    }

    #[test]
    fn early_end_gives_mean_with_less_weight() {
        let mut batch = Batch::NEW;
        fill(&mut batch, 2);
        assert!(add(&mut batch, Dwell::No, 0.0, 0.0));
        let (regressors, deflection) = batch.measurement();
        assert_eq!((deflection, regressors[2]), (4.0, 10.0));
        assert_eq!(batch.relative_weight(&learner(), false), 0.25);
        assert!((batch.relative_weight(&learner(), true) - 0.25).abs() < 1e-6, "half of sqrt(2/8)");
    }

    #[test]
    fn contact_below_shortest_is_discarded() {
        let mut batch = Batch::NEW;
        fill(&mut batch, 1);
        assert!(!add(&mut batch, Dwell::No, 0.0, 0.0));
        assert_eq!(batch.flank(), None);
    }

    #[test]
    fn other_flank_begins_new_batch() {
        let mut batch = Batch::NEW;
        fill(&mut batch, 7);
        assert!(!add(&mut batch, Dwell::On(Some(Flank::Back)), -4.0, -10.0));
        assert_eq!(batch.flank(), Some(Flank::Back));
        assert!(!fill(&mut batch, 7));
        assert!(fill(&mut batch, 1));
    }

    #[test]
    fn unknown_flank_continues_batch() {
        let mut batch = Batch::NEW;
        fill(&mut batch, 4);
        let full = (0..4).fold(false, |_, _| add(&mut batch, Dwell::On(None), 4.0, 10.0));
        assert!(full);
        assert_eq!(batch.flank(), DRIVE);
    }

    #[test]
    fn force_variation_below_noise_is_constant() {
        let mut forces = ForceStatistics::<f32>::NONE;
        assert_eq!(forces.update(1, 10.0, 1.0), 10.0);
        assert_eq!(forces.update(2, 11.0, 1.0), 10.5, "a variance of 1/4 is noise");
        let mut forces = ForceStatistics::<f32>::NONE;
        forces.update(1, 0.0, 1.0);
        assert_eq!(forces.update(2, 20.0, 1.0), 10.0 + 10.0 * (1.0 - 1.0 / 100.0));
    }
}

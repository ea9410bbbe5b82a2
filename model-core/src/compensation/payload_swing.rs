//! Detector of a load that swings faster than loads by people, weights and motions: a payload on a flexible arm. The
//! reaction of such a payload must not be fed forward as measured, because a delayed feed-forward drives the swing.
//!
//! ```text
//! (K7)  c' = (z - c)/(15 T_r),   m' = 25/s (c - m);   swing: c - m passes +-M three times, each within 1/8 s
//! ```
//!
//! Symbols: z = `reading`, the load without friction; c, m = `means`, its fast and slow mean; M = `switching.measured`,
//! the uncertainty of measured torques.

use super::thresholds::PayloadSwingThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};
use crate::numbers::state_words::state_words;

/// Detector of a swing of the load.
#[derive(Debug, Clone)]
pub(super) struct PayloadSwing<T: Real> {
    /// Fast and slow mean of the load [N m].
    means: [T; 2],
    /// Side of the slow mean on which the fast mean last was beyond m: 1, -1, or 0 at first.
    side: T,
    /// Time since the last change of the side, saturating [s].
    time_since_change: T,
    /// Changes of the side, each soon after the last [-].
    changes: T,
    /// Remaining time for which the load counts as swinging [s].
    remaining_time: T,
}
state_words! { struct PayloadSwing<T> { means, side, time_since_change, changes, remaining_time } }

impl<T: Real> PayloadSwing<T> {
    const THRESHOLDS: PayloadSwingThresholds<T> = PayloadSwingThresholds::TUNED;

    pub fn new() -> Self {
        Self {
            means: [T::ZERO; 2],
            side: T::ZERO,
            time_since_change: T::ZERO,
            changes: T::ZERO,
            remaining_time: Self::THRESHOLDS.memory,
        }
    }

    /// True if the load swings, or if it is not yet shown that it does not.
    pub fn may_swing(&self) -> bool {
        self.remaining_time > T::ZERO
    }

    /// True if a swing was detected.
    pub fn swings(&self) -> bool {
        self.may_swing() && self.changes >= Self::THRESHOLDS.changes
    }

    /// Updates the detector by the load of a period [N m]; `None` without a measurement.
    pub fn update(&mut self, tables: &CompensationTables<T>, reading: Option<T>) {
        let period = tables.clock.period;
        self.time_since_change = clamp(self.time_since_change + period, T::ZERO, T::ONE);
        let Some(reading) = reading.filter(|reading| reading.is_finite()) else { return };
        self.remaining_time = deadband(self.remaining_time, period);
        let [fast, slow] = &mut self.means;
        *fast += tables.switching.smoothing * (reading - *fast);
        *slow += tables.watch.smoothing * (*fast - *slow);
        let excess = deadband(*fast - *slow, tables.switching.measured);
        if excess == T::ZERO {
            return;
        }
        let side = if excess > T::ZERO { T::ONE } else { -T::ONE };
        if side * self.side < T::ZERO {
            self.changes = if self.time_since_change < Self::THRESHOLDS.longest_half_period {
                self.changes + T::ONE
            } else {
                T::ZERO
            };
            self.time_since_change = T::ZERO;
            if self.changes >= Self::THRESHOLDS.changes {
                self.changes = Self::THRESHOLDS.changes;
                self.remaining_time = Self::THRESHOLDS.memory;
            }
        }
        self.side = side;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::tables;

    /// Returns a detector after the load has changed sides, each time after a number of periods.
    fn alternating(changes: u32, periods: u32) -> PayloadSwing<f64> {
        let (tables, mut swing) = (tables(), PayloadSwing::new());
        // A second without a swing, so that nothing may swing any more.
        (0..1100).for_each(|_| swing.update(&tables, Some(0.0)));
        for change in 0..=changes {
            let load = if change % 2 == 0 { 6.0 } else { -6.0 };
            (0..periods).for_each(|_| swing.update(&tables, Some(load)));
        }
        swing
    }

    #[test]
    fn three_changes_are_a_swing() {
        assert!(!alternating(2, 60).swings() && alternating(4, 60).swings());
    }

    #[test]
    fn slow_changes_are_no_swing() {
        assert!(!alternating(8, 200).swings());
    }

    #[test]
    fn swing_is_remembered_for_a_second() {
        let (tables, mut swing) = (tables(), alternating(4, 60));
        (0..900).for_each(|_| swing.update(&tables, Some(-6.0)));
        assert!(swing.swings());
        (0..200).for_each(|_| swing.update(&tables, Some(-6.0)));
        assert!(!swing.swings());
    }
}

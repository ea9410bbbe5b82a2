//! Counts of one encoder in the wiring check: position, travel, and signs of a wrong resolution.

use crate::numbers::Real;
use crate::observer::sensors::counts::shortest_difference;
use crate::observer::tables::EncoderTable;

/// Counts of one encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct Track {
    has_first: bool,
    raw: u32,
    /// Counts since the first reading.
    pub position: i64,
    lowest: i64,
    highest: i64,
    /// Largest raw count beyond the range of the tables; 0 if all are in range.
    pub largest_out_of_range: u32,
    /// Power of two below the range of the tables at which the raw counts wrapped; 0 without such a wrap.
    pub wrapped_at: u32,
}

impl Track {
    /// Adds a raw count.
    pub fn add_counts<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32) {
        let within = if raw > table.last {
            self.largest_out_of_range = self.largest_out_of_range.max(raw);
            raw.checked_rem(table.wraps_at).unwrap_or(raw)
        } else {
            raw
        };
        let before = core::mem::replace(&mut self.raw, within);
        if !self.has_first {
            self.has_first = true;
            return;
        }
        let by = shortest_difference(within, before, table);
        let size = by.unsigned_abs();
        if size <= table.fastest {
            self.position = self.position.saturating_add(by.into());
            self.lowest = self.lowest.min(self.position);
            self.highest = self.highest.max(self.position);
        } else {
            self.detect_wrap(size, table);
        }
    }

    /// Detects a wrap: raw counts that jump by nearly a power of two have wrapped there.
    #[cold]
    fn detect_wrap<T: Real>(&mut self, size: u32, table: &EncoderTable<T>) {
        let Some(upper) = size.checked_next_power_of_two() else { return };
        let lower = upper >> 1;
        let is_near = |power: u32| power.abs_diff(size) <= table.fastest;
        let power = if is_near(upper) { upper } else { lower };
        if is_near(power) && power < table.last {
            self.wrapped_at = power;
        }
    }

    /// Counts between the lowest and the highest position.
    pub fn span(&self) -> i64 {
        self.highest.saturating_sub(self.lowest)
    }
}

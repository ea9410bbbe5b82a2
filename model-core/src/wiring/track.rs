//! Counts of one encoder in the wiring check: position, travel, and signs of a wrong resolution.

use crate::numbers::Real;
use crate::observer::sensors::counts::difference;
use crate::observer::tables::EncoderTable;

/// Counts of one encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct Track {
    began: bool,
    raw: u32,
    /// Counts since the first reading.
    pub position: i64,
    least: i64,
    most: i64,
    /// Largest raw count beyond the range of the tables; 0 if all are in range.
    pub beyond: u32,
    /// Power of two below the range of the tables at which the raw counts wrapped; 0 without such a wrap.
    pub wrap: u32,
}

impl Track {
    /// Adds a raw count.
    pub fn read<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32) {
        let within = if raw > table.last {
            self.beyond = self.beyond.max(raw);
            raw.checked_rem(table.wraps_at).unwrap_or(raw)
        } else {
            raw
        };
        let before = core::mem::replace(&mut self.raw, within);
        if !self.began {
            self.began = true;
            return;
        }
        let by = difference(within, before, table);
        let size = by.unsigned_abs();
        if size <= table.fastest {
            self.position = self.position.saturating_add(by.into());
            self.least = self.least.min(self.position);
            self.most = self.most.max(self.position);
        } else {
            self.jump(size, table);
        }
    }

    /// Detects a wrap: raw counts that jump by nearly a power of two have wrapped there.
    #[cold]
    fn jump<T: Real>(&mut self, size: u32, table: &EncoderTable<T>) {
        let Some(upper) = size.checked_next_power_of_two() else { return };
        let lower = upper >> 1;
        let near = |power: u32| power.abs_diff(size) <= table.fastest;
        let power = if near(upper) { upper } else { lower };
        if near(power) && power < table.last {
            self.wrap = power;
        }
    }

    /// Counts between the lowest and the highest position.
    pub fn span(&self) -> i64 {
        self.most.saturating_sub(self.least)
    }
}

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

/// Difference of both shafts' counts.
pub fn difference([motor, output]: [i64; 2], [motor_before, output_before]: [i64; 2]) -> [i64; 2] {
    [motor.saturating_sub(motor_before), output.saturating_sub(output_before)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoder() -> EncoderTable<f32> {
        EncoderTable {
            turn: 4096,
            wraps_at: 4096,
            last: 4095,
            phase: 1 << 52,
            fastest: 50,
            angle: 1.0,
            fraction: 1.0,
            turns: 1.0,
        }
    }

    /// Track of raw counts.
    fn track(raw: impl IntoIterator<Item = u32>) -> Track {
        let mut track = Track::default();
        raw.into_iter().for_each(|raw| track.add_counts(&encoder(), raw));
        track
    }

    #[test]
    fn travel_is_exact_over_wrap() {
        let track = track([4090, 10, 40, 0]);
        assert_eq!((track.position, track.span(), track.wrapped_at), (6, 46, 0));
    }

    #[test]
    fn wrap_below_range_is_detected() {
        assert_eq!(track([1020, 1]).wrapped_at, 1024);
        assert_eq!(track([500, 900]).wrapped_at, 0, "no power of two");
    }

    #[test]
    fn distant_reading_is_no_travel() {
        assert_eq!(track([0, 51]).position, 0);
        assert_eq!(track([0, 50]).position, 50);
    }

    #[test]
    fn raw_count_out_of_range_is_kept_as_evidence() {
        assert_eq!(track([0, 5000, 100]).largest_out_of_range, 5000);
    }
}

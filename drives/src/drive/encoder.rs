//! Turns and speed of an absolute single-turn encoder: unwrapping of counts and a tracking loop.
//!
//! Equations, with the period T and the bandwidth w:
//!
//! - innovation: e = angle read - angle tracked;
//! - tracked angle: p <- p + T v + 2 w T e;
//! - tracked speed: v <- v + w^2 T e, both poles at w.
//!
//! The position is the angle as it was read; only the speed comes from the loop.

use crate::turns::Turns;

/// Largest product of bandwidth and period, at which the loop is still well damped [-].
const MAX_BANDWIDTH_PERIODS: f32 = 0.3;

/// Encoder with its state.
#[derive(Debug, Clone)]
pub struct Encoder {
    counts_per_turn: u32,
    /// Last reading within a turn.
    counts: Option<u32>,
    /// Counts with all turns.
    unwrapped: i64,
    tracked: Turns,
    /// Tracked speed [turns/s].
    velocity: f32,
    silent_periods: u32,
}

impl Encoder {
    /// Encoder without a reading.
    pub fn new(counts_per_turn: u32) -> Self {
        Self { counts_per_turn, counts: None, unwrapped: 0, tracked: Turns::ZERO, velocity: 0.0, silent_periods: 0 }
    }

    /// Runs one period with a reading or none. The first reading sets the turn zero; each further reading is taken as
    /// the angle less than half a turn away.
    pub fn step(&mut self, counts: Option<u32>, bandwidth: f32, period: f32) {
        let gain = (bandwidth * period).min(MAX_BANDWIDTH_PERIODS);
        let advance = Turns::new(self.velocity * period);
        let reading = counts.and_then(|counts| counts.checked_rem(self.counts_per_turn));
        let Some(reading) = reading else {
            self.silent_periods = self.silent_periods.saturating_add(1);
            self.tracked = self.tracked.plus(advance);
            return;
        };
        self.silent_periods = 0;
        let Some(last) = self.counts.replace(reading) else {
            self.unwrapped = reading.into();
            self.tracked = self.position();
            return;
        };
        let (turn, half) = (i64::from(self.counts_per_turn), i64::from(self.counts_per_turn / 2));
        let moved = i64::from(reading) - i64::from(last);
        let shortest = if moved > half {
            moved - turn
        } else if moved < -half {
            moved + turn
        } else {
            moved
        };
        self.unwrapped = self.unwrapped.saturating_add(shortest);
        self.tracked = self.tracked.plus(advance);
        let innovation = self.position().minus(self.tracked).to_f32();
        self.tracked = self.tracked.plus(Turns::new(2.0 * gain * innovation));
        self.velocity += gain * gain / period.max(f32::MIN_POSITIVE) * innovation;
    }

    /// Angle of the last reading with all turns; the middle of its count.
    pub fn position(&self) -> Turns {
        let half_count = (1_i64 << 31).checked_div(self.counts_per_turn.into()).unwrap_or(0);
        Turns::from_counts(self.unwrapped, self.counts_per_turn).plus(Turns::from_bits(half_count))
    }

    /// Speed [turns/s].
    pub fn velocity(&self) -> f32 {
        self.velocity
    }

    /// True once there was a reading.
    pub fn has_reading(&self) -> bool {
        self.counts.is_some()
    }

    /// Control periods since the last reading.
    pub fn silent_periods(&self) -> u32 {
        self.silent_periods
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counted_across_the_wrap() {
        let mut encoder = Encoder::new(4096);
        for counts in [4090_u32, 2, 4090] {
            encoder.step(Some(counts), 100.0, 1e-3);
        }
        assert_eq!(encoder.position().to_counts(4096), 4090);
        encoder.step(Some(3), 100.0, 1e-3);
        assert_eq!(encoder.position().to_counts(4096), 4096 + 3);
    }

    #[test]
    fn speed_settles_at_the_true_speed() {
        let mut encoder = Encoder::new(16_384);
        for period in 0_u32..2000 {
            encoder.step(Some(7 * period % 16_384), 200.0, 1e-4);
        }
        let expected = 7.0 / 16_384.0 / 1e-4;
        assert!((encoder.velocity() / expected - 1.0).abs() < 0.01, "{}", encoder.velocity());
    }

    #[test]
    fn silence_is_counted_and_ends() {
        let mut encoder = Encoder::new(100);
        encoder.step(Some(1), 10.0, 1e-3);
        encoder.step(None, 10.0, 1e-3);
        encoder.step(None, 10.0, 1e-3);
        assert_eq!(encoder.silent_periods(), 2);
        encoder.step(Some(2), 10.0, 1e-3);
        assert_eq!(encoder.silent_periods(), 0);
    }

    #[test]
    fn encoder_without_counts_stays_silent() {
        let mut encoder = Encoder::new(0);
        encoder.step(Some(5), 10.0, 1e-3);
        assert!(!encoder.has_reading());
        assert_eq!(encoder.position(), Turns::ZERO);
    }
}

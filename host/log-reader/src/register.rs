//! Registers in which an encoder counts. A register of M counts wraps after M: at the end of a turn, or after several
//! turns if it is wider than a turn. Its values are 0 to M - 1, or -M/2 to M/2 - 1 if signed. Steps between readings
//! are known up to multiples of M; the shorter way round is taken.

use std::ops::RangeInclusive;

use report::number::{ESTIMATE, TYPED};

/// Widths of registers wider than a turn, as powers of two of counts.
const WIDTHS: RangeInclusive<u32> = 10..=32;
/// Largest share of readings outside of a register, equal to the share of bad readings that may be removed.
const OUTSIDE_SHARE_MAX: f64 = 0.01;
/// Distance by which rounding may carry an angle past the end of its register, as a share of the register.
const ROUNDING: f64 = 1e-6;
/// Step, as a share of a register wider than a turn, that crosses its end.
const CROSSING_SHARE: f64 = 0.75;

/// Register of an encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Register {
    /// Counts per wrap.
    pub counts: f64,
    /// True if the least value is -counts/2 instead of 0.
    pub signed: bool,
}

impl Register {
    /// Finds the narrowest register that holds the readings and whose end they cross; `None` for continuous readings. A
    /// register has at least the counts of a turn, if a turn is known. Readings with fractions wrap at a turn only.
    pub fn find(values: &[f64], turn: Option<f64>) -> Option<Self> {
        let whole = values.iter().all(|value| value.fract() == 0.0);
        let powers = WIDTHS.map(|bits| f64::from(bits).exp2());
        let wider = powers.filter(|counts| whole && turn.is_none_or(|turn| *counts > turn));
        let of_a_turn = turn.map(|turn| (turn, 0.5));
        of_a_turn
            .into_iter()
            .chain(wider.map(|counts| (counts, CROSSING_SHARE)))
            .flat_map(|(counts, across)| [false, true].map(|signed| (Self { counts, signed }, across)))
            .find(|(register, across)| register.holds_most(values) && register.is_crossed(values, *across))
            .map(|(register, _)| register)
    }

    /// Returns true if the register can hold a value.
    pub fn holds(&self, value: f64) -> bool {
        let (least, rounded) = (if self.signed { -0.5 * self.counts } else { 0.0 }, ROUNDING * self.counts);
        (least - rounded..least + self.counts + rounded).contains(&value)
    }

    fn holds_most(&self, values: &[f64]) -> bool {
        let outside = values.iter().filter(|value| !self.holds(**value)).count();
        outside as f64 <= OUTSIDE_SHARE_MAX * values.len() as f64
    }

    /// Returns true if readings step across the end of the register.
    fn is_crossed(&self, values: &[f64], share: f64) -> bool {
        values
            .windows(2)
            .any(|pair| self.holds(pair[0]) && self.holds(pair[1]) && (pair[1] - pair[0]).abs() > share * self.counts)
    }

    /// Shorter way round for a step.
    pub fn shorter(&self, step: f64) -> f64 {
        step - self.counts * (step / self.counts).round()
    }

    /// Note on the register, unless it is that of a turn from 0 on; `turn` are the encoder's counts per turn, if known.
    pub fn note(&self, name: &str, turn: Option<f64>) -> Option<String> {
        let Self { counts, signed } = *self;
        if turn == Some(counts) && !signed {
            return None;
        }
        let least = if signed { -0.5 * counts } else { 0.0 };
        let turns =
            turn.map_or_else(String::new, |turn| format!(", {} turns of the encoder", ESTIMATE.write(counts / turn)));
        Some(format!(
            "`{name}` is read as a register that wraps after {} values{turns}, starting at {}.",
            TYPED.write(counts),
            TYPED.write(least)
        ))
    }

    /// Joins readings to continuous ones. Over lost samples, given as usual time steps before each row, the encoder is
    /// assumed to keep its speed.
    pub fn join(&self, values: &mut [f64], periods_before: impl Fn(usize) -> f64) {
        let (mut last, mut before) = (values.first().copied().unwrap_or_default(), 0.0);
        for row in 1..values.len() {
            let periods = periods_before(row);
            let expected = (before * (periods - 1.0)).round();
            let step = expected + self.shorter(values[row] - last - expected);
            last = values[row];
            values[row] = values[row - 1] + step;
            before = step / periods;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// True and wrapped readings of a motion to and fro over several turns.
    fn readings(least: f64, counts: f64) -> (Vec<f64>, Vec<f64>) {
        let truth: Vec<f64> = (0..4000).map(|row| (90_000.0 * (f64::from(row) * 2e-3).sin()).round() + 7.0).collect();
        let read = truth.iter().map(|value| (value - least).rem_euclid(counts) + least).collect();
        (truth, read)
    }

    /// Registers of one or several turns, signed or not, are found and joined.
    #[test]
    fn register_is_found_and_joined() {
        for (least, counts, signed) in
            [(0.0, 16384.0, false), (-8192.0, 16384.0, true), (0.0, 65536.0, false), (-32768.0, 65536.0, true)]
        {
            let (truth, mut read) = readings(least, counts);
            let register = Register::find(&read, Some(16384.0)).expect("it begins anew");
            assert_eq!(register, Register { counts, signed });
            register.join(&mut read, |_| 1.0);
            let apart: Vec<f64> = truth.iter().zip(&read).map(|(truth, read)| truth - read).collect();
            assert!(apart.iter().all(|one| *one == apart[0]) && apart[0] % counts == 0.0, "{register:?}");
        }
    }

    /// Continuous readings over several turns have no register.
    #[test]
    fn continuous_readings_have_no_register() {
        let (truth, _) = readings(0.0, 16384.0);
        assert_eq!(Register::find(&truth, Some(16384.0)), None);
        let narrow: Vec<f64> = truth.iter().map(|value| (value / 40.0).round()).collect();
        assert_eq!(Register::find(&narrow, Some(16384.0)), None);
    }
}

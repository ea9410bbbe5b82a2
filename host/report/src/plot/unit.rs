//! Units with an SI prefix for the greatest value, and ranges of axes.

use crate::number::trimmed;

/// Unit of one axis: SI times `factor` is the number shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Number shown for 1 SI unit.
    pub factor: f64,
    /// Symbol.
    pub name: &'static str,
}

/// Torque.
pub const TORQUE: Unit = Unit { factor: 1.0, name: "N·m" };
/// Force.
pub const FORCE: Unit = Unit { factor: 1.0, name: "N" };
/// Time of a whole run.
pub const SECONDS: Unit = Unit { factor: 1.0, name: "s" };
/// Time of a close-up.
pub const MILLISECONDS: Unit = Unit { factor: 1e3, name: "ms" };
/// Computation time.
pub const MICROSECONDS: Unit = Unit { factor: 1e6, name: "µs" };
/// Ratio to a reference, 20 for a factor of ten.
pub const DECIBELS: Unit = Unit { factor: 1.0, name: "dB" };
/// Share.
pub const PERCENT: Unit = Unit { factor: 1.0, name: "%" };

impl Unit {
    /// Unit for lengths up to `greatest` [m].
    pub fn of_length(greatest: f64) -> Self {
        match greatest {
            g if g < 1e-7 => Self { factor: 1e9, name: "nm" },
            g if g < 2e-3 => Self { factor: 1e6, name: "µm" },
            g if g < 2.0 => Self { factor: 1e3, name: "mm" },
            _ => Self { factor: 1.0, name: "m" },
        }
    }

    /// Unit for angles up to `greatest` [rad].
    pub fn of_angle(greatest: f64) -> Self {
        match greatest {
            g if g < 1e-3 => Self { factor: 1e6, name: "µrad" },
            g if g < 1.0 => Self { factor: 1e3, name: "mrad" },
            g if g < 60.0 => Self { factor: 1.0, name: "rad" },
            _ => Self { factor: 1.0 / core::f64::consts::TAU, name: "turns" },
        }
    }

    /// Unit for a picture over a span of time [s].
    pub fn of_time(span: f64) -> Self {
        if span < 0.5 { MILLISECONDS } else { SECONDS }
    }
}

/// Greatest finite magnitude; 0 without values.
pub fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(0.0, |greatest, value| greatest.max(value.abs()))
}

/// Least and greatest finite value with a margin; never empty.
pub fn axis_range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    // Values beyond 1e30 are not readable in a picture, and their sums could overflow.
    let finite = values.filter(|value| value.abs() < 1e30);
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return (-1.0, 1.0);
    }
    let air = 0.06 * (high - low);
    if air > 1e-9 * low.abs().max(high.abs()) {
        return (low - air, high + air);
    }
    let half = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
    (low - half, high + half)
}

/// Number at a tick, with as many decimals as its neighbours need.
pub fn tick_label(value: f64, span: f64) -> String {
    let decimals = (1.0 - (span / 2.0).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    // All ticks have equal decimals, except for zero.
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        "0".into()
    } else {
        trimmed(&text).replace('-', "\u{2212}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_range_is_never_empty() {
        for values in [vec![], vec![0.0], vec![3.0, 3.0], vec![f64::NAN], vec![f64::INFINITY, 1.0], vec![f64::MAX]] {
            let (low, high) = axis_range(values.iter().copied());
            assert!(low < high && low.is_finite() && high.is_finite(), "{values:?} gave {low} to {high}");
        }
    }

    #[test]
    fn tick_labels_differ_from_neighbours() {
        assert_eq!(tick_label(0.1 + 0.2, 1.0), "0.3");
        assert_eq!(tick_label(-1e-17, 1.0), "0");
        assert_eq!(tick_label(-0.25, 1.0), "\u{2212}0.25");
        assert_eq!(tick_label(120.0, 200.0), "120");
    }
}

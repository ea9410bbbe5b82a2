//! Clamp and dead band. NaN passes through.

use crate::numbers::real::Real;

/// The value, limited to the range from `low` to `high`.
pub fn clamp<T: Real>(value: T, low: T, high: T) -> T {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// The value with a dead band about zero: its excess over the band on either side, else zero.
pub fn beyond<T: Real>(value: T, band: T) -> T {
    value - clamp(value, -band, band)
}

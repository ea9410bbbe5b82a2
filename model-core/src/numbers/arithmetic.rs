//! Clamp and dead band. NaN passes through.

use crate::numbers::real::Real;

/// Limits a value to the range from `low` to `high`.
pub fn clamp<T: Real>(value: T, low: T, high: T) -> T {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// Applies a dead band about zero: returns the excess of the value over the band on either side, and zero within.
pub fn deadband<T: Real>(value: T, band: T) -> T {
    value - clamp(value, -band, band)
}

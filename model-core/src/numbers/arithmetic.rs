//! Bounds on numbers that may be anything. NaN passes through.

use crate::numbers::real::Real;

/// The value, or the bound that it is beyond.
pub fn clamp<T: Real>(value: T, low: T, high: T) -> T {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// By how much the value is beyond a dead band on either side of zero.
pub fn beyond<T: Real>(value: T, band: T) -> T {
    value - clamp(value, -band, band)
}

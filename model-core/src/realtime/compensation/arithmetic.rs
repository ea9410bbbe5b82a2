//! Bounds on numbers that may be anything. NaN passes through; whoever gives a torque away looks for it there.

use crate::real::Real;

/// The value, or the bound that it is beyond.
pub(super) fn clamp<T: Real>(value: T, low: T, high: T) -> T {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// Without its sign.
pub(super) fn magnitude<T: Real>(value: T) -> T {
    if value < T::ZERO { -value } else { value }
}

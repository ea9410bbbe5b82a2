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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamp_limits_either_side() {
        assert_eq!([-3.0, 0.5, 3.0].map(|value: f32| clamp(value, -1.0, 2.0)), [-1.0, 0.5, 2.0]);
        assert!(clamp(f32::NAN, -1.0, 1.0).is_nan());
    }

    #[test]
    fn deadband_gives_excess() {
        assert_eq!([-3.0, -1.0, 0.5, 1.0, 1.5].map(|value: f32| deadband(value, 1.0)), [-2.0, 0.0, 0.0, 0.0, 0.5]);
        assert!(deadband(f32::NAN, 1.0).is_nan());
    }
}

//! Divisions of 64-bit integers without a library call, and their conversion to real numbers.

use crate::numbers::real::Real;

/// Quotient rounded towards zero; `None` for a divisor of zero. A 64-bit division is a library call of 700 bytes:
/// operands that fit 32 bits are divided in hardware, other quotients have few digits here.
#[inline(never)]
pub fn quotient(units: i64, part: i64) -> Option<i64> {
    let (left, size) = (units.unsigned_abs(), part.unsigned_abs());
    let quotient = match (u32::try_from(left), u32::try_from(size)) {
        (Ok(left), Ok(size)) => left.checked_div(size)?.into(),
        _ => quotient_of_large(left, size)?,
    };
    let quotient = quotient as i64;
    Some(if (units < 0) == (part < 0) { quotient } else { quotient.wrapping_neg() })
}

/// Long division, one binary digit per step.
#[cold]
fn quotient_of_large(mut left: u64, size: u64) -> Option<u64> {
    if size == 0 {
        return None;
    }
    let digits = size.leading_zeros().saturating_sub(left.leading_zeros());
    let (mut shifted, mut quotient) = (size << digits, 0);
    for _ in 0..=digits {
        quotient <<= 1;
        if left >= shifted {
            left -= shifted;
            quotient |= 1;
        }
        shifted >>= 1;
    }
    Some(quotient)
}

/// Half of an integer, rounded towards zero.
pub fn half(units: i64) -> i64 {
    units.wrapping_add(i64::from(units < 0)) >> 1
}

/// Quotient rounded down, so that the remainder is not negative; zero for a divisor of zero.
pub fn floor_div(units: i64, part: i64) -> i64 {
    let Some(towards_zero) = quotient(units, part) else { return 0 };
    if towards_zero.wrapping_mul(part) > units { towards_zero.wrapping_sub(1) } else { towards_zero }
}

/// Remainder of the division rounded down.
pub fn floor_mod(units: i64, part: i64) -> i64 {
    units.wrapping_sub(floor_div(units, part).wrapping_mul(part))
}

/// Converts an integer that is small in general, and saturates: conversion of wide integers is slow without hardware.
pub fn saturating_real<T: Real>(value: i64) -> T {
    let narrow = value as i32;
    T::from_i32(if i64::from(narrow) == value {
        narrow
    } else if value < 0 {
        i32::MIN
    } else {
        i32::MAX
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::random::splitmix64;

    #[test]
    fn quotient_equals_checked_div() {
        let mut state = 3;
        let mut any = || (splitmix64(&mut state) as i64) >> (splitmix64(&mut state) % 64);
        let ends = [0, 1, -1, i64::from(u32::MAX), 1 << 32, i64::MAX, i64::MIN + 1];
        let random = (0..200_000).map(|_| (any(), any()));
        for (units, part) in ends.into_iter().flat_map(|one| ends.map(|other| (one, other))).chain(random) {
            assert_eq!(quotient(units, part), units.checked_div(part), "{units} by {part}");
            assert_eq!(half(units), units / 2, "half of {units}");
        }
    }

    #[test]
    fn floor_division_has_no_negative_remainder() {
        assert_eq!((floor_div(-7, 3), floor_mod(-7, 3)), (-3, 2));
        assert_eq!((floor_div(7, 3), floor_mod(7, 3)), (2, 1));
        assert_eq!((floor_div(7, 0), floor_mod(7, 0)), (0, 7));
    }

    #[test]
    fn wide_integer_saturates() {
        assert_eq!(saturating_real::<f64>(-5), -5.0);
        assert_eq!(saturating_real::<f64>(1 << 40), f64::from(i32::MAX));
        assert_eq!(saturating_real::<f64>(-1 << 40), f64::from(i32::MIN));
    }
}

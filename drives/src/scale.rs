//! Numbers in the fields of frames: whole numbers over a range, and whole multiples of a unit.

/// Field of `bits` bits for a value between `low` and `high`: the ends are 0 and 2^bits - 1. Values out of range give
/// the ends, NaN gives the field next to zero.
///
/// ```
/// use drives::scale::{from_range, to_range};
/// assert_eq!(to_range(-12.5, -12.5, 12.5, 16), 0);
/// assert_eq!(to_range(99.0, -12.5, 12.5, 16), 65_535);
/// assert_eq!(from_range(65_535, -12.5, 12.5, 16), 12.5);
/// ```
pub fn to_range(value: f32, low: f32, high: f32, bits: u32) -> u32 {
    rounded_down(value, low, high, bits, 0.5)
}

/// Value of a field of `bits` bits between `low` and `high`.
pub fn from_range(field: u32, low: f32, high: f32, bits: u32) -> f32 {
    low + (high - low) * (field as f32 / most(bits) as f32)
}

/// Field of `bits` bits between `low` and `high` as [`to_range`] has it, but rounded down: the drivers of many makers cut
/// the fraction off. A value less than 1/64 below the next field counts as that field, so that a field survives
/// [`from_range`] and back.
///
/// ```
/// use drives::scale::to_range_down;
/// assert_eq!(to_range_down(0.0, -12.5, 12.5, 16), 32_767);
/// assert_eq!(to_range_down(99.0, -12.5, 12.5, 16), 65_535);
/// ```
pub fn to_range_down(value: f32, low: f32, high: f32, bits: u32) -> u32 {
    rounded_down(value, low, high, bits, 1.0 / 64.0)
}

/// Field between `low` and `high`, with `offset` added before rounding down.
fn rounded_down(value: f32, low: f32, high: f32, bits: u32, offset: f32) -> u32 {
    let most = most(bits);
    let value = if value.is_nan() { 0.0 } else { value };
    let share = (value.max(low).min(high) - low) / (high - low).max(f32::MIN_POSITIVE);
    (share * most as f32 + offset) as u32 & most
}

fn most(bits: u32) -> u32 {
    u32::MAX >> (32 - bits.clamp(1, 32))
}

/// Limits a value to `-most` to `most`. Without a positive limit, or for NaN, the result is zero; unlike `f32::clamp`
/// nothing panics.
///
/// ```
/// use drives::scale::limit;
/// assert_eq!(limit(-3.0, 2.0), -2.0);
/// assert_eq!(limit(f32::NAN, 2.0), 0.0);
/// assert_eq!(limit(1.0, f32::NAN), 0.0);
/// ```
pub fn limit(value: f32, most: f32) -> f32 {
    // `max` and `min` return the other operand for NaN.
    if value.is_nan() { 0.0 } else { value.max(-most.max(0.0)).min(most.max(0.0)) }
}

/// Rounds to the nearest whole number, half away from zero.
pub fn round(value: f32) -> f32 {
    libm::roundf(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_survive_a_round_trip() {
        for field in 0..=u32::from(u16::MAX) {
            let value = from_range(field, -12.5, 12.5, 16);
            assert_eq!(to_range_down(value, -12.5, 12.5, 16), field);
            assert_eq!(to_range(value, -12.5, 12.5, 16), field);
        }
    }

    #[test]
    fn field_is_rounded_down() {
        assert_eq!(to_range_down(1.97, 0.0, 4095.0, 12), 1);
        assert_eq!(to_range_down(f32::NAN, -1.0, 1.0, 12), 2047);
        assert_eq!(to_range_down(-5.0, -1.0, 1.0, 12), 0);
    }
}

//! Decimal numbers of the diagnostic channel, read and printed in bounded time and without a panic: a control period
//! includes this work. A number is `mantissa 2^exponent` with a mantissa of 50 bits, which is multiplied or divided by
//! powers of ten; cut-off bits are remembered, so that the last rounding, to the nearest `f32`, knows exact halves.
//! `core`'s conversions need 3 kB of stack and can panic.

use core::num::NonZeroU32;

use heapless::String;

/// Bits of a mantissa: with a factor of 10^4 it fits 64 bits.
const BITS: u32 = 50;
/// Significant digits that are read; later ones count as less than half of the last.
const MAX_DIGITS: u32 = 15;
/// Significant digits that tell apart all `f32`.
const ENOUGH_DIGITS: usize = 9;
/// Digits to which a number is printed if that is exact enough.
const USUAL_DIGITS: usize = 6;
/// Largest decimal exponent considered, of either sign: every number beyond is zero or infinite.
const MAX_EXPONENT: i32 = 64;
/// Decimal exponents below which and from which on numbers are printed with an exponent.
const PLAIN: core::ops::Range<i32> = -5..16;
/// Length of the longest printed number: sign, 9 digits, point and exponent; or sign, zero, point, 4 zeros and 9 digits.
pub const MAX_LENGTH: usize = 24;

/// Positive number `mantissa 2^exponent`; the mantissa has [`BITS`] bits, or is 0.
#[derive(Debug, Clone, Copy)]
struct Scaled {
    mantissa: u64,
    exponent: i32,
    /// True if bits were cut off: the number is a little larger.
    is_cut: bool,
}

impl Scaled {
    /// Number from a whole number and an exponent.
    fn new(whole: u64, exponent: i32, is_cut: bool) -> Self {
        let spare = 64 - BITS;
        let shift = whole.leading_zeros();
        let full = whole.checked_shl(shift).unwrap_or(0);
        let is_cut = is_cut || full & ((1 << spare) - 1) != 0;
        Self { mantissa: full >> spare, exponent: exponent - shift as i32 + spare as i32, is_cut }
    }

    /// Number times a power of ten.
    fn times_power_of_ten(mut self, power: i32) -> Self {
        let mut left = power.unsigned_abs().min(MAX_EXPONENT.unsigned_abs());
        // Four decimal places at a time.
        for _ in 0..=MAX_EXPONENT / 4 {
            let (places, factor) = match left {
                0 => break,
                1 => (1, TEN),
                2 => (2, const { ten_to(2) }),
                3 => (3, const { ten_to(3) }),
                _ => (4, const { ten_to(4) }),
            };
            left -= places;
            self = if power > 0 {
                Self::new(self.mantissa.wrapping_mul(factor.get().into()), self.exponent, self.is_cut)
            } else {
                let (quotient, rest) = divide(self.mantissa << (64 - BITS), factor);
                Self::new(quotient, self.exponent - (64 - BITS) as i32, self.is_cut || rest != 0)
            };
        }
        self
    }

    /// Nearest number, the even one of two.
    fn to_f32(self) -> f32 {
        if self.mantissa == 0 {
            return 0.0;
        }
        // Exponent of the highest bit, and bits that an `f32` does not have, more of them below the normal range.
        let high = self.exponent + BITS as i32 - 1;
        let surplus = (BITS - 24) as i32 + (-126 - high).max(0);
        if high > 127 {
            return f32::INFINITY;
        }
        if surplus > BITS as i32 {
            return 0.0;
        }
        let kept = (self.mantissa >> surplus) as u32;
        let rest = self.mantissa & ((1 << surplus) - 1);
        let half = 1 << (surplus - 1);
        let rounds_up = rest > half || rest == half && (self.is_cut || kept & 1 == 1);
        // The highest bit of a normal number adds one to the exponent, and so does a carry.
        let biased = (high.max(-126) + 126) as u32;
        f32::from_bits((biased << 23).wrapping_add(kept).wrapping_add(rounds_up.into()))
    }

    /// Whole part.
    fn whole(self) -> u64 {
        match self.exponent {
            0.. => self.mantissa.checked_shl(self.exponent.unsigned_abs()).unwrap_or(u64::MAX),
            _ => self.mantissa.checked_shr(self.exponent.unsigned_abs()).unwrap_or(0),
        }
    }
}

const TEN: NonZeroU32 = ten_to(1);

const fn ten_to(power: u32) -> NonZeroU32 {
    NonZeroU32::new(10_u32.pow(power)).expect("a power of ten")
}

/// Quotient and rest of a division by a number below 2^16, in divisions of 32 bits.
fn divide(number: u64, by: NonZeroU32) -> (u64, u32) {
    let (mut quotient, mut rest) = (0, 0);
    for place in [48, 32, 16, 0] {
        let part = rest << 16 | (number >> place) as u32 & 0xffff;
        quotient = quotient << 16 | u64::from(part / by);
        rest = part % by;
    }
    (quotient, rest)
}

/// Number `digits 10^exponent`.
fn from_decimal(digits: u64, exponent: i32, is_cut: bool) -> f32 {
    Scaled::new(digits, 0, is_cut).times_power_of_ten(exponent).to_f32()
}

/// Reads a number as `f32::from_str` does: sign, digits with a point, exponent; `nan`, `inf` or `infinity`.
pub fn parse(text: &str) -> Option<f32> {
    let (sign, text) = match text.as_bytes() {
        [b'-', rest @ ..] => (-1.0, rest),
        [b'+', rest @ ..] => (1.0, rest),
        all => (1.0, all),
    };
    if text.eq_ignore_ascii_case(b"nan") {
        return Some(f32::NAN);
    }
    if text.eq_ignore_ascii_case(b"inf") || text.eq_ignore_ascii_case(b"infinity") {
        return Some(sign * f32::INFINITY);
    }
    let (mut digits, mut count, mut exponent) = (0_u64, 0, 0_i32);
    let (mut has_digit, mut has_point, mut is_cut) = (false, false, false);
    let mut bytes = text.iter();
    let mut has_exponent = false;
    for byte in bytes.by_ref() {
        match byte {
            b'0'..=b'9' => {
                let digit = u64::from(byte - b'0');
                has_digit = true;
                if count < MAX_DIGITS {
                    digits = digits.wrapping_mul(10).wrapping_add(digit);
                    count += u32::from(digits > 0);
                    exponent -= i32::from(has_point);
                } else {
                    is_cut |= digit > 0;
                    exponent += i32::from(!has_point);
                }
            }
            b'.' if !has_point => has_point = true,
            b'e' | b'E' => {
                has_exponent = true;
                break;
            }
            _ => return None,
        }
    }
    if has_exponent {
        exponent = exponent.saturating_add(parse_exponent(bytes.as_slice())?);
    }
    has_digit.then(|| sign * from_decimal(digits, exponent, is_cut))
}

fn parse_exponent(text: &[u8]) -> Option<i32> {
    let (sign, digits) = match text {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        all => (1, all),
    };
    let mut value = 0_i32;
    for byte in digits {
        let digit = byte.is_ascii_digit().then(|| i32::from(byte - b'0'))?;
        value = value.saturating_mul(10).saturating_add(digit).min(9999);
    }
    (!digits.is_empty()).then_some(sign * value)
}

/// Number as text with six digits, or as many more as [`parse`] needs to read it back: plain from 1e-5 to below 1e16,
/// else with an exponent.
pub fn print(number: f32) -> String<MAX_LENGTH> {
    let mut text = String::new();
    // A text that is too long would be cut off; none is.
    let mut push = |byte: u8| {
        let _ = text.push(char::from(byte));
    };
    if number.is_nan() {
        b"NaN".iter().for_each(|byte| push(*byte));
        return text;
    }
    if number.is_sign_negative() {
        push(b'-');
    }
    if number.is_infinite() {
        b"inf".iter().for_each(|byte| push(*byte));
        return text;
    }
    if number == 0.0 {
        push(b'0');
        return text;
    }
    let Digits { digits, count, exponent } = shortest(number.abs());
    let digits = || digits.into_iter().take(count);
    let zeros = |count: i32| core::iter::repeat_n(b'0', count.clamp(0, 16) as usize);
    if !PLAIN.contains(&exponent) {
        for (place, digit) in digits().enumerate() {
            if place == 1 {
                push(b'.');
            }
            push(digit);
        }
        push(b'e');
        if exponent < 0 {
            push(b'-');
        }
        let (tens, ones) = (exponent.unsigned_abs() / 10 % 10, exponent.unsigned_abs() % 10);
        if tens > 0 {
            push(b'0' + tens as u8);
        }
        push(b'0' + ones as u8);
    } else if exponent < 0 {
        b"0.".iter().copied().chain(zeros(-1 - exponent)).chain(digits()).for_each(push);
    } else {
        for (place, digit) in (0..).zip(digits()) {
            if place == exponent + 1 {
                push(b'.');
            }
            push(digit);
        }
        zeros(exponent + 1 - count as i32).for_each(push);
    }
    text
}

/// Digits as characters, without zeros at the end.
struct Digits {
    digits: [u8; ENOUGH_DIGITS],
    count: usize,
    /// Decimal exponent of the first digit.
    exponent: i32,
}

/// Fewest digits that are read back as a positive finite number.
fn shortest(number: f32) -> Digits {
    let bits = number.to_bits();
    let (fraction, biased) = (bits & 0x7f_ffff, (bits >> 23) as i32);
    let whole = if biased == 0 { fraction } else { fraction | 1 << 23 };
    let scaled = Scaled::new(whole.into(), biased.max(1) - 150, false);
    // Floor of the decimal logarithm, or one more or less.
    let exponent = ((scaled.exponent + BITS as i32 - 1) * 1233) >> 12;
    let lead = ENOUGH_DIGITS as i32 + 2;
    let decimal = scaled.times_power_of_ten(lead - exponent).whole();
    let (digits, first) = split(decimal);
    let exponent = exponent + 15 - first as i32 - lead;
    let mut found = Digits { digits: [b'0'; ENOUGH_DIGITS], count: 0, exponent };
    for count in USUAL_DIGITS..=ENOUGH_DIGITS {
        found = round(&digits, first, count, exponent);
        if value(&found) == number {
            break;
        }
    }
    let zeros = found.digits.iter().take(found.count).rev().take_while(|digit| **digit == b'0').count();
    found.count = (found.count - zeros.min(found.count)).max(1);
    found
}

/// Sixteen decimal digits of a number, the highest first, and the place of the first that is not 0.
fn split(number: u64) -> ([u8; 16], usize) {
    let (mut digits, mut rest) = ([0; 16], number);
    for digit in digits.iter_mut().rev() {
        let (quotient, last) = divide(rest, TEN);
        (*digit, rest) = (last as u8, quotient);
    }
    let first = digits.iter().position(|digit| *digit > 0).unwrap_or(15);
    (digits, first)
}

/// The first `count` digits from the place `first` on, rounded by the next digit.
fn round(digits: &[u8; 16], first: usize, count: usize, exponent: i32) -> Digits {
    let mut rounded = [b'0'; ENOUGH_DIGITS];
    let kept = digits.iter().skip(first).take(count);
    rounded.iter_mut().zip(kept).for_each(|(place, digit)| *place = b'0' + digit);
    let mut carries = digits.get(first + count).is_some_and(|next| *next >= 5);
    for digit in rounded.iter_mut().take(count).rev() {
        if !carries {
            break;
        }
        carries = *digit == b'9';
        *digit = if carries { b'0' } else { *digit + 1 };
    }
    if carries {
        // All digits were 9.
        rounded = [b'0'; ENOUGH_DIGITS];
        rounded[0] = b'1';
    }
    Digits { digits: rounded, count, exponent: exponent + i32::from(carries) }
}

fn value(digits: &Digits) -> f32 {
    let whole = digits
        .digits
        .iter()
        .take(digits.count)
        .fold(0_u32, |sum, digit| sum.wrapping_mul(10).wrapping_add(u32::from(digit.wrapping_sub(b'0'))));
    from_decimal(whole.into(), digits.exponent + 1 - digits.count as i32, false)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::format;
    use std::string::{String, ToString};

    use super::*;

    /// Numbers over all exponents, in steps that no power of two divides, and the ends of the range.
    fn numbers() -> impl Iterator<Item = f32> {
        let ends = [f32::MIN_POSITIVE, f32::MAX, f32::from_bits(1), f32::from_bits(0x7f_ffff), 16_777_216.0, 0.1, 1e16];
        (1..0x7f80_0000_u32).step_by(10_007).map(f32::from_bits).chain(ends)
    }

    /// Every number that `std` prints is read as by `std`, in either notation.
    #[test]
    fn printed_numbers_are_read_as_by_std() {
        for number in numbers() {
            for text in [format!("{number}"), format!("{number:e}"), format!("-{number:.9e}"), format!("{number:.3}")] {
                assert_eq!(parse(&text), text.parse().ok(), "{text}");
            }
        }
    }

    #[test]
    fn odd_texts_are_read_as_by_std() {
        let words = [
            "",
            "-",
            "+",
            ".",
            "e",
            "e5",
            ".e5",
            "1e",
            "1e+",
            "1e-",
            "1.2.3",
            "1e5.0",
            "0x10",
            "1_000",
            " 1",
            "1 ",
            "5.",
            ".5",
            "+.5e+1",
            "-0",
            "0e99999999999",
            "1e99999999999",
            "1e-99999999999",
            "00000000000000000000000000012",
            "inf",
            "-INF",
            "+Infinity",
            "infinit",
            "nan",
            "NaN",
            "8388608.5",
            "8388609.5",
            "16777217",
            "16777219",
            "33554433e0",
            "340282356779733661637539395458142568447",
            "7e-46",
            "7.1e-46",
            "1.17549429e-38",
            "0.00000000000000000000000000000000000000000000000000000000000000000001e68",
            "999999999999999999e-18",
            "123456789012345678901234567890",
        ];
        for word in words {
            let (own, expected) = (parse(word), word.parse::<f32>().ok());
            let bits = |number: Option<f32>| number.map(|number| if number.is_nan() { 1 } else { number.to_bits() });
            assert_eq!(bits(own), bits(expected), "{word}: {own:?}, {expected:?}");
        }
    }

    /// Plain numbers are printed as by `std`, others with its digits and an exponent.
    #[test]
    fn numbers_are_printed_as_by_std() {
        for number in numbers() {
            let own = print(number);
            let is_plain = (1e-5..1e16).contains(&number);
            let expected = if is_plain { number.to_string() } else { format!("{number:e}") };
            // At a power of two the nearest of the shortest texts may not be the nearest text; numbers below the normal
            // range are told apart by less than six digits.
            if number.to_bits() & 0x7f_ffff != 0 && number >= f32::MIN_POSITIVE {
                assert_eq!(own.as_str(), expected);
            }
            assert_eq!(own.parse(), Ok(number), "{own}");
        }
    }

    #[test]
    fn special_numbers_are_printed() {
        let printed = [f32::NAN, f32::INFINITY, -f32::INFINITY, 0.0, -0.0, -1.5]
            .map(|number| String::from(print(number).as_str()));
        assert_eq!(printed, ["NaN", "inf", "-inf", "0", "-0", "-1.5"]);
    }

    /// No text is longer than its buffer.
    #[test]
    fn longest_text_fits() {
        let longest = numbers().map(|number| print(-number).len()).max();
        assert!(longest.is_some_and(|length| length < MAX_LENGTH), "{longest:?}");
    }
}

//! Scalar type of the core: `f32` on the board, `f64` for tests that need smaller rounding errors. The trait has only
//! operations with equal bits on host and target: no fused operations, no functions of the platform.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::state_words::StateWords;

/// Real number with bit-exact arithmetic on every host and target.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + nalgebra::Scalar
    + nalgebra::ClosedAddAssign
    + nalgebra::ClosedMulAssign
    + num_traits::Zero
    + num_traits::One
    + StateWords
{
    /// 0.
    const ZERO: Self;
    /// 1/2.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// 3.
    const THREE: Self;
    /// 4.
    const FOUR: Self;
    /// 6.
    const SIX: Self;
    /// 1/4.
    const QUARTER: Self;
    /// 1/3.
    const THIRD: Self;
    /// 1/6.
    const SIXTH: Self;
    /// 1/8.
    const EIGHTH: Self;
    /// 3/8.
    const THREE_EIGHTHS: Self;
    /// 1/20.
    const TWENTIETH: Self;
    /// 2^-32.
    const PHASE_UNIT: Self;
    /// Smallest magnitude in the state; smaller values become zero. Large enough that no product in a step is denormal, and
    /// small enough against 1 that no accuracy is lost.
    const LEAST: Self;
    /// The only NaN in the state.
    const NAN: Self;
    /// Polynomial of sin(2 pi t) / t in t^2; see `numbers::phase`.
    const SINE: [Self; 4];
    /// Polynomial of cos(2 pi t) in t^2.
    const COSINE: [Self; 5];
    /// Nearest value; for tables and tests, never in the step.
    fn from_f64(value: f64) -> Self;
    /// Exact value; for tests and reports, never in the step.
    fn to_f64(self) -> f64;
    /// Nearest value of a 32-bit integer.
    fn from_i32(value: i32) -> Self;
    /// Nearest value of a 64-bit integer.
    fn from_i64(value: i64) -> Self;
    /// Integer rounded towards zero, saturating; NaN gives 0.
    fn to_i64(self) -> i64;
    /// Phase of an advance in 2^-32 periods, without whole periods, rounded towards zero to at least 24 bits of a period; NaN
    /// gives 0.
    fn to_phase(self) -> u32;
    /// Hyperbolic tangent, with equal bits on host and target.
    fn tanh(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Square root, accurate to a few units in the last place; zero for zero, negative values and NaN. Newton's iteration from
    /// half the exponent, with equal bits everywhere.
    fn square_root(self) -> Self;
    /// Canonical form, which no floating-point mode changes: zero for magnitudes below `LEAST`, `NAN` for non-finite values.
    /// Compares integers, because flags of floating-point comparisons are slow to read on a Cortex-M4F.
    fn canonical(self) -> Self;
    /// Returns true for finite values of at least `LEAST` in magnitude, which are in canonical form; needs one comparison.
    /// Returns false for zero, although zero is in canonical form.
    fn is_ordinary(self) -> bool;
    /// Returns true for values that are neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Bits for a digest.
    fn bits(self) -> u64;
}

macro_rules! real {
    ($scalar:ty, $bits:ty, $phase:expr, $of_whole:expr, $whole:expr, $tanh:path, $least:expr, $nan:expr, $first:expr, $steps:expr) => {
        impl Real for $scalar {
            const ZERO: Self = 0.0;
            const HALF: Self = 0.5;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const THREE: Self = 3.0;
            const FOUR: Self = 4.0;
            const SIX: Self = 6.0;
            const QUARTER: Self = 0.25;
            const THIRD: Self = 1.0 / 3.0;
            const SIXTH: Self = 1.0 / 6.0;
            const EIGHTH: Self = 0.125;
            const THREE_EIGHTHS: Self = 0.375;
            const TWENTIETH: Self = 0.05;
            const LEAST: Self = $least;
            const NAN: Self = $nan;
            const PHASE_UNIT: Self = 1.0 / 4_294_967_296.0;
            // Chebyshev interpolation on |t| <= 1/8, computed for this file; largest errors 2.4e-9 and 5e-11, below
            // half a unit of an f32.
            #[allow(clippy::excessive_precision, reason = "the same digits serve both scalars")]
            const SINE: [Self; 4] = [6.283185287840101, -41.34166260181908, 81.5925482067425, -75.40184030935168];
            #[allow(clippy::excessive_precision, reason = "the same digits serve both scalars")]
            const COSINE: [Self; 5] =
                [0.9999999999525445, -19.739208650243476, 64.93931617191193, -85.44284838305786, 59.22028772473335];
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            fn to_f64(self) -> f64 {
                self.into()
            }
            fn from_i32(value: i32) -> Self {
                value as Self
            }
            fn from_i64(value: i64) -> Self {
                $of_whole(value)
            }
            fn to_i64(self) -> i64 {
                $whole(self)
            }
            fn to_phase(self) -> u32 {
                $phase(self)
            }
            fn tanh(self) -> Self {
                $tanh(self)
            }
            fn abs(self) -> Self {
                <$scalar>::abs(self)
            }
            fn square_root(self) -> Self {
                if self > 0.0 {
                    // Iteration for 1 / sqrt(x): each step doubles the number of correct digits.
                    let mut inverse = <$scalar>::from_bits($first - (self.to_bits() >> 1));
                    for _ in 0..$steps {
                        inverse *= 1.5 - 0.5 * self * inverse * inverse;
                    }
                    self * inverse
                } else {
                    0.0
                }
            }
            fn canonical(self) -> Self {
                let size = self.abs().to_bits();
                if size < Self::LEAST.to_bits() {
                    0.0
                } else if size < Self::INFINITY.to_bits() {
                    self
                } else {
                    <Self as Real>::NAN
                }
            }
            #[inline(always)]
            fn is_ordinary(self) -> bool {
                const LEAST: $bits = (<$scalar as Real>::LEAST).to_bits() << 1;
                const BEYOND: $bits = (<$scalar>::INFINITY.to_bits() << 1) - LEAST;
                (self.to_bits() << 1).wrapping_sub(LEAST) < BEYOND
            }
            fn is_finite(self) -> bool {
                <$scalar>::is_finite(self)
            }
            fn bits(self) -> u64 {
                self.to_bits().into()
            }
        }
    };
}

/// Converts with a hardware instruction: a conversion to 64 bits is a library call of 29 instructions on a Cortex-M4F.
fn single_phase(advance: f32) -> u32 {
    ((advance * (1.0 / 256.0)) as i32 as u32) << 8
}

fn double_phase(advance: f64) -> u32 {
    advance as i64 as u32
}

/// Converts values of 32 bits with a hardware instruction: a conversion from 64 bits is a library call.
#[inline(never)]
fn single_of_whole(value: i64) -> f32 {
    let lower = value as i32;
    if i64::from(lower) == value { lower as f32 } else { single_of_large(value) }
}

/// Converts the upper 32 bits of the magnitude. The lowest of them is set if any bit below is set, so that the result is
/// rounded as the whole number would be.
#[cold]
#[inline(never)]
fn single_of_large(value: i64) -> f32 {
    let size = value.unsigned_abs();
    let below = 32_u32.saturating_sub(size.leading_zeros());
    let upper = size >> below;
    let is_more = upper << below != size;
    let power = f32::from_bits((127 + below) << 23);
    let single = (upper as u32 | u32::from(is_more)) as f32 * power;
    if value < 0 { -single } else { single }
}

fn double_of_whole(value: i64) -> f64 {
    value as f64
}

/// Converts upper and lower half with two hardware instructions: a conversion to 64 bits is a library call. Every
/// difference is exact; values beyond the range saturate.
#[inline(always)]
fn single_whole(value: f32) -> i64 {
    const HALF: f32 = 4_294_967_296.0;
    if value.abs() < 0.5 * HALF * HALF {
        let upper = (value * (1.0 / HALF)) as i32;
        let rest = value - upper as f32 * HALF;
        let lower = i64::from(rest.abs() as u32);
        (i64::from(upper) << 32) + if rest < 0.0 { -lower } else { lower }
    } else if value > 0.0 {
        i64::MAX
    } else if value < 0.0 {
        i64::MIN
    } else {
        0
    }
}

fn double_whole(value: f64) -> i64 {
    value as i64
}

// `LEAST` is 2^-40 and 2^-300; `NAN` the quiet NaN without sign or payload. The last two are the constant for the first
// guess of an inverse root (3/2 of the exponent's bias minus half of the number's bits, within 3.5 %) and the number of
// Newton steps.
real!(
    f32,
    u32,
    single_phase,
    single_of_whole,
    single_whole,
    libm::tanhf,
    1.0 / (1_u64 << 40) as f32,
    Self::from_bits(0x7fc0_0000),
    0x5f37_59df,
    3
);
real!(
    f64,
    u64,
    double_phase,
    double_of_whole,
    double_whole,
    libm::tanh,
    Self::from_bits((1023 - 300) << 52),
    Self::from_bits(0x7ff8_0000_0000_0000),
    0x5fe6_eb50_c7b5_37a9,
    5
);

#[cfg(test)]
mod tests {
    use super::Real;
    use crate::numbers::random::splitmix64;

    #[test]
    fn to_i64_equals_cast() {
        let mut state = 7;
        let ends =
            [0x5e7f_ffff, 0x5e80_0000, 0x5eff_ffff, 0x5f00_0000, 0x4f80_0000, 0x4f7f_ffff, 0x7f80_0000, 0x7fc0_0000];
        let random = (0..1_000_000).map(|_| splitmix64(&mut state) as u32);
        for bits in ends.into_iter().flat_map(|bits| [bits, bits | 1 << 31]).chain(random) {
            let value = f32::from_bits(bits);
            assert_eq!(value.to_i64(), value as i64, "{value:e}");
        }
    }

    #[test]
    fn from_i64_equals_cast() {
        let mut state = 7;
        // Midpoints between two adjacent numbers, and the integers next to the midpoints, at every magnitude.
        let halves = (24..63).flat_map(|bit| {
            let half = (1_i64 << bit) + (1 << (bit - 24));
            [half - 1, half, half + 1, half + (1 << (bit - 23)), (1 << bit) - 1]
        });
        let random = (0..1_000_000).map(|_| (splitmix64(&mut state) as i64) >> (splitmix64(&mut state) % 64));
        for value in [0, i64::MAX, i64::MIN, i64::MIN + 1].into_iter().chain(halves).chain(random) {
            for value in [value, value.wrapping_neg()] {
                assert_eq!(f32::from_i64(value).to_bits(), (value as f32).to_bits(), "{value}");
            }
        }
    }
}

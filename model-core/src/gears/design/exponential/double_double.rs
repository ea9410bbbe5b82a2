//! Double-double arithmetic: a number is the unevaluated sum of two f64, about 32 digits (Dekker; Knuth's exact sum). It
//! keeps the rounding errors of the doublings below the resolution of the resulting f64. Only the operations of matrix
//! products; no fused operations, so the bits are equal on every host.

use core::ops::{Add, AddAssign, Mul, MulAssign};

use num_traits::{One, Zero};

/// Number high + low, with |low| at most half a unit in the last place of high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// Factor 2^27 + 1, which splits an f64 into halves with exact products.
const SPLITTER: f64 = 134_217_729.0;

impl DoubleDouble {
    /// Converts an f64 exactly.
    pub fn new(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// Returns the nearest f64.
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// Returns the exact product of two f64.
    pub fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
        Self { high, low: a_low * b_low - (((high - a_high * b_high) - a_low * b_high) - a_high * b_low) }
    }

    /// Multiplies by a power of two, exactly.
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }

    /// Divides by an f64 other than zero.
    pub fn over(self, divisor: f64) -> Self {
        let first = self.high / divisor;
        let rest = self + Self::product(-first, divisor);
        joined(first, rest.high / divisor)
    }
}

fn halves(value: f64) -> (f64, f64) {
    let shifted = SPLITTER * value;
    let high = shifted - (shifted - value);
    (high, value - high)
}

/// Returns the exact sum of two f64.
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let b_part = high - a;
    DoubleDouble { high, low: (a - (high - b_part)) + (b - b_part) }
}

/// Returns the exact sum of two f64; `high` must have the larger magnitude.
fn joined(high: f64, low: f64) -> DoubleDouble {
    let total = high + low;
    DoubleDouble { high: total, low: low - (total - high) }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let first = joined(high.high, high.low + low.high);
        joined(first.high, first.low + low.low)
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        joined(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl MulAssign for DoubleDouble {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Zero for DoubleDouble {
    fn zero() -> Self {
        Self::new(0.0)
    }

    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for DoubleDouble {
    fn one() -> Self {
        Self::new(1.0)
    }
}

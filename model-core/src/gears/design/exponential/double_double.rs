//! Double-double arithmetic: a number held as an unevaluated sum of two f64, some 32 digits (Dekker; Knuth's exact sum). The
//! doublings are done in it, so that their rounding never shows in the f64 that comes out. Only the operations of matrix
//! products; nothing is fused, so the bits are the same on every host.

use core::ops::{Add, AddAssign, Mul, MulAssign};

use num_traits::{One, Zero};

/// high + low, with |low| at most half a unit of high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// 2^27 + 1 splits an f64 into halves whose products are exact.
const SPLITTER: f64 = 134_217_729.0;

impl DoubleDouble {
    /// An f64 as it is.
    pub fn new(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// The nearest f64.
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// Product of two f64, exact.
    pub fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
        Self { high, low: a_low * b_low - (((high - a_high * b_high) - a_low * b_high) - a_high * b_low) }
    }

    /// Times a power of two, exact.
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }

    /// Quotient by an f64 other than zero.
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

/// Sum of two f64, exact.
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let b_part = high - a;
    DoubleDouble { high, low: (a - (high - b_part)) + (b - b_part) }
}

/// Sum of two f64 of which the first is the larger, exact.
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

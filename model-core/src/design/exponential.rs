//! Precise integration: exp(A h) - I by 2^N doublings of a short Taylor series, and the integrals of exp against
//! powers of time. Pure matrices; it knows no gears.
//!
//! With E(t) = exp(A t) - I, E(2t) = 2 E(t) + E(t)^2. Doubling E instead of exp(A t) keeps the small increment apart
//! from the identity: squaring I + E would round E to the unit's grid N times over (Zhong, precise integration).

use nalgebra::DMatrix;
use std::vec::Vec;

/// Norm of A h / 2^N at which the series starts: below it the series needs few terms and its own rounding is nil.
const SERIES_NORM: f64 = 0.125;

/// Relative remainder allowed to the series, half a unit of an f64.
const REMAINDER: f64 = 1.1102230246251565e-16;

/// Doublings and series terms for a matrix of a given norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// N: the interval is h / 2^N at first.
    pub doublings: u32,
    /// Highest power of A h / 2^N in the series.
    pub terms: u32,
}

impl Plan {
    /// The fewest doublings that bring `norm` (of A h) to 1/8 or below, then the fewest terms whose remainder,
    /// bounded by a^L / (L + 1)! / (1 - a / (L + 2)) relative to the leading term, is below half a unit.
    pub fn new(norm: f64) -> Self {
        let mut start = norm;
        let mut doublings = 0;
        while start > SERIES_NORM {
            start *= 0.5;
            doublings += 1;
        }
        let (mut terms, mut remainder) = (1, start * 0.5);
        while remainder / (1.0 - start / (f64::from(terms) + 2.0)) > REMAINDER {
            terms += 1;
            remainder *= start / (f64::from(terms) + 1.0);
        }
        Self { doublings, terms }
    }
}

/// Largest column sum of magnitudes.
pub fn norm(matrix: &DMatrix<f64>) -> f64 {
    matrix.column_iter().map(|column| column.iter().map(|value| value.abs()).sum()).fold(0.0, f64::max)
}

/// exp(A h) - I for a square A; entries must be finite.
pub fn exponential_minus_identity(matrix: &DMatrix<f64>, step: f64) -> DMatrix<f64> {
    let scaled = matrix * step;
    let plan = Plan::new(norm(&scaled));
    let start = scaled * libm::ldexp(1.0, -(plan.doublings as i32));
    let mut increment = series(&start, plan.terms);
    for _ in 0..plan.doublings {
        increment = &increment * 2.0 + &increment * &increment;
    }
    increment
}

/// Horner's form of A + A^2/2! + ... + A^L/L!.
fn series(matrix: &DMatrix<f64>, terms: u32) -> DMatrix<f64> {
    let identity = DMatrix::identity(matrix.nrows(), matrix.ncols());
    let mut sum = identity.clone();
    for term in (2..=terms).rev() {
        sum = &identity + matrix * sum / f64::from(term);
    }
    matrix * sum
}

/// Flow over a step and the integrals of its response to inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// exp(A h) - I.
    pub transition: DMatrix<f64>,
    /// For k = 0, 1, ..: the integral over s in [0, h] of exp(A (h - s)) B (s / h)^k.
    pub input_integrals: Vec<DMatrix<f64>>,
}

/// Flow of v' = A v + B u and its response to u = (s / h)^k for every k below `powers`.
///
/// One exponential of A bordered by B and a chain of integrators gives them all: the chain makes s^k / k!.
pub fn flow(matrix: &DMatrix<f64>, inputs: &DMatrix<f64>, step: f64, powers: usize) -> Flow {
    let (size, width) = (matrix.nrows(), inputs.ncols());
    let mut bordered = DMatrix::zeros(size + powers * width, size + powers * width);
    bordered.view_mut((0, 0), (size, size)).copy_from(&(matrix * step));
    bordered.view_mut((0, size), (size, width)).copy_from(&(inputs * step));
    for power in 1..powers {
        let (row, column) = (size + (power - 1) * width, size + power * width);
        bordered.view_mut((row, column), (width, width)).copy_from(&DMatrix::identity(width, width));
    }
    let increment = exponential_minus_identity(&bordered, 1.0);
    let mut factorial = 1.0;
    let input_integrals = (0..powers)
        .map(|power| {
            factorial *= (power as f64).max(1.0);
            increment.view((0, size + power * width), (size, width)) * factorial
        })
        .collect();
    Flow { transition: increment.view((0, 0), (size, size)).into_owned(), input_integrals }
}

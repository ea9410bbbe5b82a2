//! Precise integration: exp(A h) - I by N doublings of a short Taylor series, and integrals of exp times powers of
//! time, for (S7).
//!
//! With E(t) = exp(A t) - I, E(2t) = 2 E(t) + E(t)^2. Doubling E instead of exp(A t) keeps the small increment apart
//! from the identity: squaring I + E would round E to the resolution of 1 at each of N doublings (Zhong, precise
//! integration). Doubling also amplifies rounding errors, without limit if the motion grows before it decays; the
//! calculation therefore uses double-double numbers and rounds once, at the end.
//!
//! Equations: (P13) in docs/theory/paper.md.

mod double_double;

use double_double::DoubleDouble;
use nalgebra::DMatrix;
use std::vec::Vec;

/// Largest norm of A h / 2^N for the series, which then needs few terms.
pub const SERIES_NORM: f64 = 0.125;

/// Largest relative remainder of the series: 2^-106, the resolution of a double-double number.
pub const REMAINDER: f64 = 1.232_595_164_407_831e-32;

/// Number of doublings and of series terms for a matrix of a given norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScalingPlan {
    /// N: the interval of the series is h / 2^N.
    pub doublings: u32,
    /// Highest power of A h / 2^N in the series.
    pub terms: u32,
}

impl ScalingPlan {
    /// Finds the smallest number of doublings that brings `norm` (of A h) to 1/8 or below, then the smallest number of
    /// terms with a remainder, bounded by a^L / (L + 1)! / (1 - a / (L + 2)) relative to the leading term, of at most
    /// `REMAINDER`. A norm that is not finite counts as zero; the result is then meaningless.
    pub fn new(norm: f64) -> Self {
        let mut start = if norm.is_finite() { norm } else { 0.0 };
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

/// Returns the largest column sum of magnitudes.
pub fn norm(matrix: &DMatrix<f64>) -> f64 {
    matrix.column_iter().map(|column| column.iter().map(|value| value.abs()).sum()).fold(0.0, f64::max)
}

/// Flow over a step and the integrals of the response to inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// exp(A h) - I.
    pub transition: DMatrix<f64>,
    /// Integrals over s in [0, h] of exp(A (h - s)) B (s / h)^k for k = 0, 1, ...
    pub input_integrals: Vec<DMatrix<f64>>,
}

/// Returns exp(A h) - I for a square A; entries must be finite.
pub fn exponential_minus_identity(matrix: &DMatrix<f64>, step: f64) -> DMatrix<f64> {
    flow(matrix, &DMatrix::zeros(matrix.nrows(), 0), step, 0).transition
}

/// Computes the flow of v' = A v + B u and the response to u = (s / h)^k for every k below `powers`; entries must be finite.
pub fn flow(matrix: &DMatrix<f64>, inputs: &DMatrix<f64>, step: f64, powers: usize) -> Flow {
    let plan = ScalingPlan::new(norm(matrix) * step.abs());
    let part = libm::ldexp(1.0, -(plan.doublings as i32));
    let over_part = |values: &DMatrix<f64>| values.map(|value| DoubleDouble::product(value, step).scaled(part));
    let mut response = Response::series(&over_part(matrix), &over_part(inputs), powers, plan.terms);
    for _ in 0..plan.doublings {
        response = response.doubled();
    }
    let rounded = |values: &DMatrix<DoubleDouble>| values.map(DoubleDouble::rounded);
    Flow { transition: rounded(&response.increment), input_integrals: response.integrals.iter().map(rounded).collect() }
}

/// Flow over an interval t in double-double numbers.
struct Response {
    /// E(t) = exp(A t) - I.
    increment: DMatrix<DoubleDouble>,
    /// J_k(t), the integral over s in [0, t] of exp(A (t - s)) B (s / t)^k.
    integrals: Vec<DMatrix<DoubleDouble>>,
}

impl Response {
    /// Computes E = sum over m >= 1 of (A t)^m / m! and J_k = sum over m >= 0 of (A t)^m B t k! / (m + k + 1)! from A t and
    /// B t. The remainder of any J_k, relative to its leading term, is at most the relative remainder of E.
    fn series(matrix: &DMatrix<DoubleDouble>, inputs: &DMatrix<DoubleDouble>, powers: usize, terms: u32) -> Self {
        // Binomial coefficient m! / (k! (m - k)!); all values are integers far below 2^53.
        let choose = |m: u32, k: u32| (0..k).fold(1.0, |value, i| value * f64::from(m - i) / f64::from(i + 1));
        // (A t)^m / m! and (A t)^(m - 1) B t / m!.
        let (mut term, mut driven) = (matrix.clone(), inputs.clone());
        let mut response =
            Self { increment: term.clone(), integrals: (0..powers).map(|k| over(&driven, k as f64 + 1.0)).collect() };
        for m in 2..=terms {
            term = over(&(matrix * term), f64::from(m));
            driven = over(&(matrix * driven), f64::from(m));
            response.increment += &term;
            for (k, integral) in (0..).zip(&mut response.integrals) {
                *integral += over(&driven, choose(m + k, k));
            }
        }
        response
    }

    /// Returns the response over twice the interval: E(2t) = 2 E + E^2, and J_k(2t) = ((I + E) J_k + sum over j <= k of
    /// k over j J_j) / 2^k, because the input of the second half, ((1 + s / t) / 2)^k, is a sum of the powers (s / t)^j.
    fn doubled(&self) -> Self {
        let mut row = Vec::new();
        let integrals = self.integrals.iter().enumerate().map(|(k, integral)| {
            // Row k of Pascal's triangle.
            row.push(1.0);
            for j in (1..k).rev() {
                row[j] += row[j - 1];
            }
            let first_half = integral + &self.increment * integral;
            let both = self
                .integrals
                .iter()
                .zip(&row)
                .fold(first_half, |sum, (second, ways)| sum + second.map(|value| value * DoubleDouble::new(*ways)));
            both.map(|value| value.scaled(libm::ldexp(1.0, -(k as i32))))
        });
        let integrals = integrals.collect();
        Self { increment: self.increment.map(|value| value.scaled(2.0)) + &self.increment * &self.increment, integrals }
    }
}

fn over(matrix: &DMatrix<DoubleDouble>, divisor: f64) -> DMatrix<DoubleDouble> {
    matrix.map(|value| value.over(divisor))
}

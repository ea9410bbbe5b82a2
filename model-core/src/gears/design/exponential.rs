//! Precise integration: exp(A h) - I by 2^N doublings of a short Taylor series, and the integrals of exp against
//! powers of time. Pure matrices; it knows no gears.
//!
//! With E(t) = exp(A t) - I, E(2t) = 2 E(t) + E(t)^2. Doubling E instead of exp(A t) keeps the small increment apart
//! from the identity: squaring I + E would round E to the unit's grid N times over (Zhong, precise integration).
//! Doubling also multiplies rounding, without limit where the motion grows before it decays; so everything is done in
//! double-double numbers and rounded once, at the end.

mod double_double;

use double_double::DoubleDouble;
use nalgebra::DMatrix;
use std::vec::Vec;

/// Norm of A h / 2^N up to which the series is used: below it the series needs few terms.
pub const SERIES_NORM: f64 = 0.125;

/// Relative remainder allowed to the series, a unit of a double-double number: 2^-106.
pub const REMAINDER: f64 = 1.232_595_164_407_831e-32;

/// Doublings and series terms for a matrix of a given norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScalingPlan {
    /// N: the interval is h / 2^N at first.
    pub doublings: u32,
    /// Highest power of A h / 2^N in the series.
    pub terms: u32,
}

impl ScalingPlan {
    /// The fewest doublings that bring `norm` (of A h) to 1/8 or below, then the fewest terms whose remainder,
    /// bounded by a^L / (L + 1)! / (1 - a / (L + 2)) relative to the leading term, is below what is allowed. A norm
    /// that is not finite is treated as zero: its result means nothing.
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

/// Largest column sum of magnitudes.
pub fn norm(matrix: &DMatrix<f64>) -> f64 {
    matrix.column_iter().map(|column| column.iter().map(|value| value.abs()).sum()).fold(0.0, f64::max)
}

/// Flow over a step and the integrals of its response to inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// exp(A h) - I.
    pub transition: DMatrix<f64>,
    /// For k = 0, 1, ..: the integral over s in [0, h] of exp(A (h - s)) B (s / h)^k.
    pub input_integrals: Vec<DMatrix<f64>>,
}

/// exp(A h) - I for a square A; entries must be finite.
pub fn exponential_minus_identity(matrix: &DMatrix<f64>, step: f64) -> DMatrix<f64> {
    flow(matrix, &DMatrix::zeros(matrix.nrows(), 0), step, 0).transition
}

/// Flow of v' = A v + B u and its response to u = (s / h)^k for every k below `powers`; entries must be finite.
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

/// What a flow is over an interval t, before it is rounded.
struct Response {
    /// E(t) = exp(A t) - I.
    increment: DMatrix<DoubleDouble>,
    /// J_k(t): the integral over s in [0, t] of exp(A (t - s)) B (s / t)^k.
    integrals: Vec<DMatrix<DoubleDouble>>,
}

impl Response {
    /// E = sum over m >= 1 of (A t)^m / m!, and J_k = sum over m >= 0 of (A t)^m B t k! / (m + k + 1)!, from A t and
    /// B t. The remainder of any J_k, relative to its leading term, is at most that of E.
    fn series(matrix: &DMatrix<DoubleDouble>, inputs: &DMatrix<DoubleDouble>, powers: usize, terms: u32) -> Self {
        // Of m! / (k! (m - k)!), all whole numbers far below 2^53.
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

    /// Over twice the interval: E(2t) = 2 E + E^2, and J_k(2t) = ((I + E) J_k + sum over j <= k of k over j J_j) / 2^k,
    /// since the input of the second half, ((1 + s / t) / 2)^k, is a sum of those of the first.
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

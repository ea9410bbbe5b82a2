//! A value with half of its 95 % interval.

use super::regression::Solution;
use super::statistics::{mean, student};

/// Half of a 95 % interval over the standard deviation of a normal distribution.
pub(super) const NORMAL_QUANTILE: f64 = 1.96;

/// A value and half of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    pub value: f64,
    pub half: f64,
}

impl Estimate {
    /// Estimate of one unknown of a solution.
    pub fn of_unknown(solution: &Solution, unknown: usize) -> Self {
        Self { value: solution.values[unknown], half: solution.half(&[(unknown, 1.0)]) }
    }

    /// Mean of repeated values, with the interval from their scatter (Student).
    pub fn of_repeats(values: &[f64]) -> Self {
        let (count, value) = (values.len() as f64, mean(values));
        let variance = values.iter().map(|one| (one - value).powi(2)).sum::<f64>() / (count - 1.0);
        Self { value, half: student(count - 1.0) * (variance / count).sqrt() }
    }

    /// Estimate of a smooth function of a solution, by its slopes.
    pub fn of_function(solution: &Solution, value: f64, slopes: &[(usize, f64)]) -> Self {
        Self { value, half: solution.half(slopes) }
    }

    /// Widens the interval by a systematic error.
    pub fn widened_by(self, systematic: f64) -> Self {
        Self { half: self.half + systematic.abs(), ..self }
    }

    /// Widens the interval by an independent error, given as half of its 95 % interval.
    pub fn with_independent_error(self, independent: f64) -> Self {
        Self { half: self.half.hypot(independent), ..self }
    }

    /// Limits half of the interval from below by the resolution of the readings.
    pub fn with_half_at_least(self, least: f64) -> Self {
        // An infinite interval stays infinite.
        Self { half: if self.half.is_finite() { self.half.max(least) } else { self.half }, ..self }
    }

    /// Converts to another unit.
    pub fn scaled(self, factor: f64) -> Self {
        Self { value: self.value * factor, half: self.half * factor.abs() }
    }
}

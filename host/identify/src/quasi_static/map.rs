//! Error map: output less motor by place, averaged over loads; a long wave and a ripple.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use crate::statistics::{mean, rms};

/// Degree of the polynomial of the long wave.
const LONG_WAVE_DEGREE: usize = 6;
/// Least half periods of the ripple over the range, beyond the polynomial's reach.
const RIPPLE_HALF_PERIODS_MIN: usize = 6;

/// Error map in its parts, each over the bins.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Whole map, without its mean.
    pub whole: Vec<f64>,
    /// Long wave, with the straight line.
    pub long_wave: Vec<f64>,
    /// Map less long wave.
    pub ripple: Vec<f64>,
    /// Slope of a straight line through the map.
    pub slope: f64,
}

impl Map {
    /// Map of the mean curves of all groups.
    pub fn from_means(places: &[f64], means: &[Vec<f64>]) -> Self {
        let at = |place: usize| means.iter().map(|group| group[place]).sum::<f64>() / means.len() as f64;
        let mut whole: Vec<f64> = (0..places.len()).map(at).collect();
        let middle = mean(&whole);
        whole.iter_mut().for_each(|value| *value -= middle);
        let (first, last) = (places[0], places[places.len() - 1]);
        // Chebyshev polynomials are well conditioned for least squares.
        let share = |place: &f64| ((2.0 * place - first - last) / (last - first)).clamp(-1.0, 1.0);
        let basis = |row: usize, column: usize| (column as f64 * share(&places[row]).acos()).cos();
        // At least two bins per unknown: with fewer, the highest terms would be noise.
        let unknowns = (1 + LONG_WAVE_DEGREE).min(places.len() / 2);
        let long_wave = fitted(&DMatrix::from_fn(places.len(), unknowns, basis), &whole).0;
        let line = fitted(&DMatrix::from_fn(places.len(), 2, basis), &whole).1;
        let ripple = whole.iter().zip(&long_wave).map(|(whole, long)| whole - long).collect();
        Self { whole, long_wave, ripple, slope: 2.0 * line[1] / (last - first) }
    }

    /// Range of the long wave.
    pub fn long_wave_range(&self) -> f64 {
        range(self.long_wave.iter().copied())
    }

    /// Travel of the output per travel of the motor.
    pub fn output_per_motor(&self) -> f64 {
        1.0 / (1.0 - self.slope)
    }

    /// Rise of the straight line over the range of the long wave about the line.
    pub fn straightness(&self, places: &[f64]) -> f64 {
        let line = self.slope * (places[places.len() - 1] - places[0]);
        let bent = range(self.long_wave.iter().zip(places).map(|(wave, place)| wave - self.slope * place));
        line.abs() / bent
    }

    /// Root mean square of the ripple.
    pub fn ripple_rms(&self) -> f64 {
        rms(&self.ripple)
    }

    /// Period and amplitude of the strongest sine in the ripple.
    pub fn strongest_ripple(&self, places: &[f64]) -> Option<(f64, f64)> {
        let span = places[places.len() - 1] - places[0];
        let sine = |half_periods: usize| {
            let rate = 0.5 * TAU * half_periods as f64 / span;
            let column = |row: usize, column: usize| {
                let phase = rate * (places[row] - places[0]);
                [phase.cos(), phase.sin()][column]
            };
            let parts = fitted(&DMatrix::from_fn(places.len(), 2, column), &self.ripple).1;
            (2.0 * span / half_periods as f64, parts[0].hypot(parts[1]))
        };
        // At least four bins per period.
        (RIPPLE_HALF_PERIODS_MIN..=places.len() / 2).map(sine).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Largest less least value.
fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    high - low
}

/// Least squares: fitted curve and coefficients.
fn fitted(basis: &DMatrix<f64>, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let solved = basis.clone().svd(true, true).solve(&DVector::from_column_slice(values), 1e-9);
    let solved = solved.unwrap_or_else(|_| DVector::zeros(basis.ncols()));
    ((basis * &solved).as_slice().to_vec(), solved.as_slice().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Line, long wave and ripple of a synthetic map are recovered.
    #[test]
    fn map_separates_line_wave_and_ripple() {
        let places: Vec<f64> = (0..100).map(|bin| 500.0 + 10.0 * f64::from(bin)).collect();
        let wave = |x: f64| 3.0 * (TAU * (x - 500.0) / 990.0).cos() + 0.01 * x;
        let curve: Vec<f64> = places.iter().map(|x| wave(*x) + 0.5 * (TAU * x / 60.0).sin()).collect();
        let map = Map::from_means(&places, &[curve.clone(), curve]);
        assert!((map.slope - 0.01).abs() < 1e-3, "{}", map.slope);
        assert!(map.straightness(&places) < 2.0, "a line of 10 beside a wave of 6");
        assert!((map.ripple_rms() - 0.5 / 2f64.sqrt()).abs() < 0.02, "{}", map.ripple_rms());
        let (period, amplitude) = map.strongest_ripple(&places).expect("a ripple");
        assert!((period - 60.0).abs() < 1.0 && (amplitude - 0.5).abs() < 0.05, "{period} {amplitude}");
    }
}

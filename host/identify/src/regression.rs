//! Linear least squares with robust weights, prior widths for unknowns that a log may not determine, and intervals from
//! blocks of time, because residuals within a block are correlated.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

/// Rounds of reweighting outliers.
const REWEIGHTING_ROUNDS: usize = 12;
/// After ROUNDS_BEFORE_EXCLUSION rounds, residuals above EXCLUSION_SIGMA deviations are excluded: they stem from
/// another state, such as bouncing teeth.
const ROUNDS_BEFORE_EXCLUSION: usize = 5;
const EXCLUSION_SIGMA: f64 = 8.0;
/// Number of deviations above which the weight of a residual decreases (Huber); the usual constant for 95 % efficiency.
const HUBER: f64 = 1.345;

/// Error amplification above which the interval of an unknown is widened. The error amplification is the change of the
/// unknown's contribution to the values if each equation is off by one, with the worst signs. It is at most 5.5 in
/// simulated reversal tests of the presets. With sines of one strength it is up to 10,000: encoder errors are
/// confounded with tooth errors, and inertia with compliance.
const AMPLIFICATION_SEPARATED: f64 = 6.0;
/// Error amplification from which on an unknown counts as not identifiable; REPETITION_PENALTY is subtracted if all
/// strokes are alike.
const AMPLIFICATION_MAX: f64 = 20.0;
const REPETITION_PENALTY: f64 = 14.0;

/// Coefficients of an equation that are measured and therefore noisy.
pub const NOISY_COEFFICIENTS: usize = 3;

/// Covariance of an equation's noisy coefficients and of its value, the value last. Plain least squares would
/// underestimate unknowns with noisy coefficients.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NoiseCovariance(pub [[f64; NOISY_COEFFICIENTS + 1]; NOISY_COEFFICIENTS + 1]);

/// System of equations, to be solved by least squares.
#[derive(Debug, Clone, Default)]
pub struct Equations {
    rows: Vec<Vec<f64>>,
    values: Vec<f64>,
    /// Block of time of each equation.
    blocks: Vec<usize>,
    /// Group of each equation, independent of time, whose residuals may be correlated; empty without groups.
    groups: Vec<usize>,
    /// Covariance of the coefficients of each equation; empty if all coefficients are exact.
    noise_covariances: Vec<NoiseCovariance>,
    /// Indices of the noisy coefficients.
    noisy: [usize; NOISY_COEFFICIENTS],
    /// Repetition of the moments, 0 to 1: residuals of repeated moments are not independent.
    repetition: f64,
}

/// Solution of a system.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Unknowns.
    pub values: DVector<f64>,
    /// Covariance of the unknowns.
    pub covariance: DMatrix<f64>,
    /// Half of a 95 % interval over the standard deviation.
    pub coverage_factor: f64,
    /// Covariance and reach from groups instead of blocks; `None` without groups.
    by_groups: Option<(DMatrix<f64>, f64)>,
    /// Residuals of the equations.
    pub residuals: Vec<f64>,
    /// Standard deviation of the residuals, outliers excluded.
    pub noise: f64,
    /// Addition to half of an unknown's interval for confounding: residuals may be systematic, and below some size the
    /// weights do not reduce them. Repeated moments count in full, others as far as the amplification exceeds
    /// AMPLIFICATION_SEPARATED. Infinite if the unknown is not separated from the others.
    pub confounded: DVector<f64>,
    /// Share of the information on the noisy-coefficient unknowns that is not scatter; the lowest of the unknowns.
    pub reliability: f64,
}

impl Equations {
    /// Empty system for moments of a repetition of 0 to 1.
    pub fn with_repetition(repetition: f64) -> Self {
        Self { repetition, ..Self::default() }
    }

    /// Adds an equation.
    pub fn push(&mut self, row: Vec<f64>, value: f64, block: usize) {
        self.rows.push(row);
        self.values.push(value);
        self.blocks.push(block);
    }

    /// Assigns the last equation to a group with correlated residuals; then every equation needs a group.
    pub fn set_group(&mut self, group: usize) {
        self.groups.push(group);
    }

    /// Adds an equation with noisy coefficients; then every equation must have them.
    pub fn push_noisy(
        &mut self,
        row: Vec<f64>,
        value: f64,
        block: usize,
        noisy: [usize; NOISY_COEFFICIENTS],
        scatter: NoiseCovariance,
    ) {
        self.noisy = noisy;
        self.noise_covariances.push(scatter);
        self.push(row, value, block);
    }

    /// Number of equations.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Solves the system; each unknown is expected near zero within its width, which may be infinite.
    ///
    /// Returns `None` if the equations are too few, or do not determine the unknowns.
    pub fn solve(&self, widths: &[f64]) -> Option<Solution> {
        self.solve_considering(widths, &[])
    }

    /// Solves the system with some unknowns held near zero by their widths but uncertain by a standard deviation; the
    /// covariance includes their effect (Schmidt's considered parameters).
    pub fn solve_considering(&self, widths: &[f64], considered: &[(usize, f64)]) -> Option<Solution> {
        let unknowns = widths.len();
        if self.count() < 2 * unknowns {
            return None;
        }
        // Columns are scaled to equal size, so that the solution does not depend on units.
        let scale = |column: usize| {
            let sum: f64 = self.rows.iter().map(|row| row[column] * row[column]).sum();
            if sum > 0.0 { (sum / self.count() as f64).sqrt() } else { 1.0 }
        };
        let scales: Vec<f64> = (0..unknowns).map(scale).collect();
        let matrix = DMatrix::from_fn(self.count(), unknowns, |row, column| self.rows[row][column] / scales[column]);
        let values = DVector::from_column_slice(&self.values);
        let prior = DVector::from_fn(unknowns, |column, _| (widths[column] * scales[column]).powi(-2));
        let mut weights = DVector::from_element(self.count(), 1.0);
        let mut noise = robust_deviation(&self.values);
        let mut solved = DVector::zeros(unknowns);
        let mut information = DMatrix::zeros(unknowns, unknowns);
        let mut residuals = values.clone();
        let mut reliability = 1.0;
        for round in 0..REWEIGHTING_ROUNDS {
            let floor = 1e-12 * (1.0 + values.amax());
            let sharpness = 1.0 / (noise * noise).max(floor * floor);
            let weighted = DMatrix::from_fn(self.count(), unknowns, |row, column| {
                matrix[(row, column)] * weights[row] * sharpness
            });
            let seen = weighted.transpose() * &matrix + DMatrix::from_diagonal(&prior);
            let mut right = weighted.transpose() * &values;
            information = seen.clone();
            for (scatter, weight) in self.noise_covariances.iter().zip(weights.iter()) {
                self.remove_noise_bias(scatter, weight * sharpness, &scales, &mut information, &mut right);
            }
            solved = information.clone().cholesky()?.solve(&right);
            if !self.noise_covariances.is_empty() {
                let (seen, true_one) = (seen.cholesky()?.inverse(), information.clone().cholesky()?.inverse());
                let part = |unknown: &usize| seen[(*unknown, *unknown)] / true_one[(*unknown, *unknown)];
                reliability = self.noisy.iter().map(part).fold(1.0, f64::min);
            }
            residuals = &values - &matrix * &solved;
            noise = robust_deviation(residuals.as_slice()).max(floor);
            weights = residuals.map(|residual| {
                let size = residual.abs() / noise.max(1e-300);
                if round >= ROUNDS_BEFORE_EXCLUSION && size > EXCLUSION_SIGMA {
                    0.0
                } else {
                    (HUBER / size.max(1e-300)).min(1.0)
                }
            });
        }
        let inverse = information.cholesky()?.inverse();
        let fit =
            WeightedFit { matrix: &matrix, weights: &weights, residuals: &residuals, solved: &solved, scales: &scales };
        let [by_blocks, by_groups] =
            [&self.blocks, &self.groups].map(|labels| self.score_covariance(labels, &fit, noise));
        let influence = &inverse * matrix.transpose();
        let confounded = DVector::from_fn(unknowns, |unknown, _| {
            let pulled = weights.iter().enumerate().map(|(row, weight)| weight * influence[(unknown, row)].abs());
            let inflation = pulled.sum::<f64>() / (noise * noise);
            let beyond = if inflation < AMPLIFICATION_MAX - REPETITION_PENALTY * self.repetition {
                (inflation - AMPLIFICATION_SEPARATED).max(self.repetition * inflation)
            } else {
                f64::INFINITY
            };
            HUBER * noise * beyond / scales[unknown]
        });
        let mut beside = DMatrix::zeros(unknowns, unknowns);
        for &(unknown, deviation) in considered {
            let weighted = matrix.column(unknown).component_mul(&weights) / (noise * noise);
            let mut moved = -(&inverse * (matrix.transpose() * weighted));
            moved[unknown] = 1.0;
            moved *= deviation * scales[unknown];
            beside += &moved * moved.transpose();
        }
        let covariance = |meat: &DMatrix<f64>| {
            let sum = &inverse * (meat + DMatrix::from_diagonal(&prior)) * &inverse + &beside;
            DMatrix::from_fn(unknowns, unknowns, |a, b| sum[(a, b)] / (scales[a] * scales[b]))
        };
        // Student's 97.5 % quantile, by the first terms of its expansion.
        let coverage_factor = |count: usize, fitted: usize| {
            let freedom = count.saturating_sub(fitted.min(count / 2)).max(3) as f64;
            1.96 + 2.37 / freedom + 2.82 / (freedom * freedom)
        };
        Some(Solution {
            values: DVector::from_fn(unknowns, |column, _| solved[column] / scales[column]),
            covariance: covariance(&by_blocks.0),
            coverage_factor: coverage_factor(by_blocks.1, unknowns),
            by_groups: (by_groups.1 > 1).then(|| (covariance(&by_groups.0), coverage_factor(by_groups.1, 1))),
            confounded,
            residuals: residuals.as_slice().to_vec(),
            noise,
            reliability,
        })
    }

    /// Removes the bias by noisy coefficients from the normal equations.
    fn remove_noise_bias(
        &self,
        NoiseCovariance(scatter): &NoiseCovariance,
        weight: f64,
        scales: &[f64],
        sums: &mut DMatrix<f64>,
        right: &mut DVector<f64>,
    ) {
        for (place, &row) in self.noisy.iter().enumerate() {
            for (other, &column) in self.noisy.iter().enumerate() {
                sums[(row, column)] -= weight * scatter[place][other] / (scales[row] * scales[column]);
            }
            right[row] -= weight * scatter[place][NOISY_COEFFICIENTS] / scales[row];
        }
    }

    /// Sum over the labels of the squared score of each label, and the number of labels.
    fn score_covariance(&self, labels: &[usize], fit: &WeightedFit<'_>, noise: f64) -> (DMatrix<f64>, usize) {
        let WeightedFit { matrix, weights, residuals, solved, scales } = *fit;
        let unknowns = matrix.ncols();
        let mut scores: BTreeMap<usize, DVector<f64>> = BTreeMap::new();
        for (row, label) in labels.iter().enumerate() {
            let score = scores.entry(*label).or_insert_with(|| DVector::zeros(unknowns));
            let weight = weights[row] / (noise * noise);
            *score += matrix.row(row).transpose() * (weight * residuals[row]);
            // The bias by noisy coefficients is removed here as in the normal equations.
            let Some(NoiseCovariance(scatter)) = self.noise_covariances.get(row) else { continue };
            for (place, &unknown) in self.noisy.iter().enumerate() {
                let others = self.noisy.iter().enumerate();
                let of_others: f64 =
                    others.map(|(other, &column)| scatter[place][other] * solved[column] / scales[column]).sum();
                score[unknown] += weight * (of_others - scatter[place][NOISY_COEFFICIENTS]) / scales[unknown];
            }
        }
        // Small-sample correction: each block has moved the solution towards itself.
        let correction = scores.len() as f64 / (scores.len() as f64 - 1.0).max(1.0)
            * (self.count() as f64 / (self.count() - unknowns) as f64);
        let mut sum = DMatrix::zeros(unknowns, unknowns);
        scores.values().for_each(|score| sum += score * score.transpose() * correction);
        (sum, scores.len())
    }
}

/// Matrix, weights and residuals of a weighted solution.
struct WeightedFit<'p> {
    matrix: &'p DMatrix<f64>,
    weights: &'p DVector<f64>,
    residuals: &'p DVector<f64>,
    solved: &'p DVector<f64>,
    scales: &'p [f64],
}

impl Solution {
    /// Half of the 95 % interval of a smooth function of the unknowns, by its slopes.
    pub fn half(&self, slopes: &[(usize, f64)]) -> f64 {
        let mut slope = DVector::zeros(self.values.len());
        slopes.iter().for_each(|(unknown, by)| slope[*unknown] = *by);
        let half = |covariance: &DMatrix<f64>, coverage_factor: f64| {
            coverage_factor * (slope.transpose() * covariance * &slope)[(0, 0)].max(0.0).sqrt()
        };
        let scatter = half(&self.covariance, self.coverage_factor);
        let scatter = self
            .by_groups
            .as_ref()
            .map_or(scatter, |(covariance, coverage_factor)| scatter.max(half(covariance, *coverage_factor)));
        let confounded =
            slopes.iter().filter(|(_, by)| *by != 0.0).map(|(unknown, by)| by.abs() * self.confounded[*unknown]);
        scatter + confounded.sum::<f64>()
    }

    /// Returns true if the equations separate an unknown from the others.
    pub fn is_separated(&self, unknown: usize) -> bool {
        self.confounded[unknown] == 0.0
    }

    /// Standard deviation of an unknown.
    pub fn deviation(&self, unknown: usize) -> f64 {
        self.covariance[(unknown, unknown)].max(0.0).sqrt()
    }
}

/// Robust standard deviation, from the median of the sizes.
fn robust_deviation(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    1.4826 * sizes.get(sizes.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Line through noisy points, a few of them far off.
    fn line(wild: f64) -> Equations {
        let mut equations = Equations::default();
        for index in 0..400_usize {
            let x = index as f64 / 400.0;
            let scatter = 0.01 * ((index * 7919 % 101) as f64 / 50.0 - 1.0);
            let value = 2.0 + 3.0 * x + scatter + if index % 40 == 0 { wild } else { 0.0 };
            equations.push(vec![1.0, x, 0.0], value, index / 10);
        }
        equations
    }

    /// A few outliers hardly move the solution.
    #[test]
    fn regression_outliers_are_downweighted() {
        let widths = [f64::INFINITY, f64::INFINITY, 0.5];
        let solution = line(5.0).solve(&widths).expect("determined");
        assert!((solution.values[0] - 2.0).abs() < 0.01 && (solution.values[1] - 3.0).abs() < 0.01, "{solution:?}");
    }

    /// An error common to a group widens the interval.
    #[test]
    fn regression_group_error_widens_interval() {
        // Values of one kind are too large, at any time.
        let mean = |grouped: bool| {
            let mut equations = Equations::default();
            for index in 0..400_usize {
                let kind = index * 7919 % 101 % 8;
                let scatter = 0.01 * ((index * 104_729 % 211) as f64 / 105.0 - 1.0);
                equations.push(vec![1.0], 1.0 + scatter + if kind == 3 { 0.02 } else { 0.0 }, index / 10);
                if grouped {
                    equations.set_group(kind);
                }
            }
            equations.solve(&[f64::INFINITY]).expect("determined").half(&[(0, 1.0)])
        };
        let [alone, grouped] = [false, true].map(mean);
        assert!(grouped > 2.0 * alone && grouped < 0.02, "{alone} {grouped}");
    }

    /// The uncertainty of a held unknown appears in the unknowns correlated with it.
    #[test]
    fn regression_considered_error_propagates() {
        // The line's slope is held at 3 with a deviation of 0.5, which moves the mean by 0.25.
        let mut equations = line(0.0);
        equations.values.iter_mut().zip(&equations.rows).for_each(|(value, row)| *value -= 3.0 * row[1]);
        let widths = [f64::INFINITY, 1e-9, 1e-9];
        let [alone, beside] = [vec![], vec![(1, 0.5)]]
            .map(|considered| equations.solve_considering(&widths, &considered).expect("determined"));
        assert!(alone.deviation(0) < 0.001 && alone.deviation(1) < 1e-6, "{alone:?}");
        assert!((beside.deviation(0) - 0.25).abs() < 0.005, "{}", beside.deviation(0));
        assert!((beside.deviation(1) - 0.5).abs() < 1e-6, "{}", beside.deviation(1));
    }

    /// An unobserved unknown keeps its prior width; without one there is no solution.
    #[test]
    fn regression_unobserved_keeps_prior() {
        let solution = line(0.0).solve(&[f64::INFINITY, f64::INFINITY, 0.5]).expect("determined");
        assert!((solution.deviation(2) - 0.5).abs() < 1e-9, "{}", solution.deviation(2));
        assert!(line(0.0).solve(&[f64::INFINITY; 3]).is_none(), "and without a width there is no solution");
    }
}

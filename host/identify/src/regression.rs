//! Linear least squares with robust weights, prior widths for parameters that a log may not determine, and intervals
//! from blocks of time, since residuals within a block are correlated.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

/// Rounds of turning down outliers.
const ROUNDS: usize = 12;
/// After so many of them what lies so many deviations beyond is taken for none of what the equations are about, such as teeth
/// that bounce on.
const TURNED_DOWN: usize = 5;
const NONE_OF_IT: f64 = 8.0;
/// Residuals beyond this many deviations count less (Huber); the usual constant for 95 % efficiency.
const HUBER: f64 = 1.345;

/// What every equation is off by, each by one and with the worst sign, moves the part that an unknown has in the values by so
/// much at most in a log that tells the unknowns apart. In simulated reversal tests of the presets it is 5.5 and less, and with
/// sines of one strength, where errors of encoders and teeth, inertia and compliance go with one another, up to 10,000.
const TOLD_APART: f64 = 6.0;
/// From here on an unknown is not told apart from the others; so much sooner where all strokes are alike.
const NOT_TOLD_APART: f64 = 20.0;
const SOONER: f64 = 14.0;

/// Coefficients of an equation that are measured and therefore scatter.
pub const SCATTERING: usize = 3;

/// How some coefficients of an equation and its value scatter: their covariance, the value last. Least squares alone would
/// find unknowns with scattering coefficients too small.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Scatter(pub [[f64; SCATTERING + 1]; SCATTERING + 1]);

/// A system of equations to be solved in the least-squares sense.
#[derive(Debug, Clone, Default)]
pub struct Equations {
    rows: Vec<Vec<f64>>,
    values: Vec<f64>,
    /// Block of time that an equation belongs to.
    blocks: Vec<usize>,
    /// Group of equations, whenever they were, whose residuals may be alike; nothing if there are none.
    groups: Vec<usize>,
    /// How coefficients scatter; nothing if none do.
    scatters: Vec<Scatter>,
    /// Which coefficients these are.
    scattering: [usize; SCATTERING],
    /// How far their moments repeat one another, 0 to 1: what they leave over is then no scatter.
    repeated: f64,
}

/// Their solution.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The unknowns.
    pub values: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Half of a 95 % interval is this times a standard deviation.
    pub reach: f64,
    /// Likewise where it is groups whose residuals are alike, with its reach; nothing without groups.
    by_groups: Option<(DMatrix<f64>, f64)>,
    /// What the equations leave over.
    pub residuals: Vec<f64>,
    /// Its standard deviation, outliers apart.
    pub noise: f64,
    /// Half of an interval that is to be added to that of an unknown that goes with others: what the equations leave over may be
    /// no scatter, and is not turned down up to some size. Where their moments repeat one another that counts whole, elsewhere
    /// as far as it moves an unknown by more than it might where unknowns are told apart. Infinite if this one is not.
    pub confounded: DVector<f64>,
    /// Part of what the equations seem to say of an unknown with scattering coefficients that is no scatter; of the worst.
    pub reliability: f64,
}

impl Equations {
    /// None yet, of moments that repeat one another so far, 0 to 1.
    pub fn of_moments(repeated: f64) -> Self {
        Self { repeated, ..Self::default() }
    }

    /// One more equation.
    pub fn push(&mut self, row: Vec<f64>, value: f64, block: usize) {
        self.rows.push(row);
        self.values.push(value);
        self.blocks.push(block);
    }

    /// The last equation is one of a group whose residuals may be alike; all must be in one then.
    pub fn in_group(&mut self, group: usize) {
        self.groups.push(group);
    }

    /// One more equation whose coefficients of these unknowns scatter; all equations must be of this kind then.
    pub fn push_scattering(
        &mut self,
        row: Vec<f64>,
        value: f64,
        block: usize,
        scattering: [usize; SCATTERING],
        scatter: Scatter,
    ) {
        self.scattering = scattering;
        self.scatters.push(scatter);
        self.push(row, value, block);
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Solves them; each unknown is expected near zero within its width, which may be infinite.
    ///
    /// `None` if there are too few, or if they do not determine the unknowns.
    pub fn solve(&self, widths: &[f64]) -> Option<Solution> {
        self.solve_considering(widths, &[])
    }

    /// The same where some unknowns are held near zero by their widths, but are uncertain by a standard deviation that these
    /// equations are not trusted to better: what that moves is in the covariance (Schmidt's considered parameters).
    pub fn solve_considering(&self, widths: &[f64], considered: &[(usize, f64)]) -> Option<Solution> {
        let unknowns = widths.len();
        if self.count() < 2 * unknowns {
            return None;
        }
        // Columns of equal size, so that the solution does not depend on units.
        let scale = |column: usize| {
            let sum: f64 = self.rows.iter().map(|row| row[column] * row[column]).sum();
            if sum > 0.0 { (sum / self.count() as f64).sqrt() } else { 1.0 }
        };
        let scales: Vec<f64> = (0..unknowns).map(scale).collect();
        let matrix = DMatrix::from_fn(self.count(), unknowns, |row, column| self.rows[row][column] / scales[column]);
        let values = DVector::from_column_slice(&self.values);
        let prior = DVector::from_fn(unknowns, |column, _| (widths[column] * scales[column]).powi(-2));
        let mut weights = DVector::from_element(self.count(), 1.0);
        let mut noise = spread(&self.values);
        let mut solved = DVector::zeros(unknowns);
        let mut information = DMatrix::zeros(unknowns, unknowns);
        let mut residuals = values.clone();
        let mut reliability = 1.0;
        for round in 0..ROUNDS {
            let floor = 1e-12 * (1.0 + values.amax());
            let sharpness = 1.0 / (noise * noise).max(floor * floor);
            let weighted = DMatrix::from_fn(self.count(), unknowns, |row, column| {
                matrix[(row, column)] * weights[row] * sharpness
            });
            let seen = weighted.transpose() * &matrix + DMatrix::from_diagonal(&prior);
            let mut right = weighted.transpose() * &values;
            information = seen.clone();
            for (scatter, weight) in self.scatters.iter().zip(weights.iter()) {
                self.take_off(scatter, weight * sharpness, &scales, &mut information, &mut right);
            }
            solved = information.clone().cholesky()?.solve(&right);
            if !self.scatters.is_empty() {
                let (seen, true_one) = (seen.cholesky()?.inverse(), information.clone().cholesky()?.inverse());
                let part = |unknown: &usize| seen[(*unknown, *unknown)] / true_one[(*unknown, *unknown)];
                reliability = self.scattering.iter().map(part).fold(1.0, f64::min);
            }
            residuals = &values - &matrix * &solved;
            noise = spread(residuals.as_slice()).max(floor);
            weights = residuals.map(|residual| {
                let size = residual.abs() / noise.max(1e-300);
                if round >= TURNED_DOWN && size > NONE_OF_IT { 0.0 } else { (HUBER / size.max(1e-300)).min(1.0) }
            });
        }
        let inverse = information.cholesky()?.inverse();
        let pulls =
            Pulls { matrix: &matrix, weights: &weights, residuals: &residuals, solved: &solved, scales: &scales };
        let [by_blocks, by_groups] = [&self.blocks, &self.groups].map(|labels| self.scatter(labels, &pulls, noise));
        let pull = &inverse * matrix.transpose();
        let confounded = DVector::from_fn(unknowns, |unknown, _| {
            let pulled = weights.iter().enumerate().map(|(row, weight)| weight * pull[(unknown, row)].abs());
            let inflation = pulled.sum::<f64>() / (noise * noise);
            let beyond = if inflation < NOT_TOLD_APART - SOONER * self.repeated {
                (inflation - TOLD_APART).max(self.repeated * inflation)
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
        let reach = |count: usize, fitted: usize| {
            let freedom = count.saturating_sub(fitted.min(count / 2)).max(3) as f64;
            1.96 + 2.37 / freedom + 2.82 / (freedom * freedom)
        };
        Some(Solution {
            values: DVector::from_fn(unknowns, |column, _| solved[column] / scales[column]),
            covariance: covariance(&by_blocks.0),
            reach: reach(by_blocks.1, unknowns),
            by_groups: (by_groups.1 > 1).then(|| (covariance(&by_groups.0), reach(by_groups.1, 1))),
            confounded,
            residuals: residuals.as_slice().to_vec(),
            noise,
            reliability,
        })
    }

    /// Takes what scatter alone puts into the sums out of them.
    fn take_off(
        &self,
        Scatter(scatter): &Scatter,
        weight: f64,
        scales: &[f64],
        sums: &mut DMatrix<f64>,
        right: &mut DVector<f64>,
    ) {
        for (place, &row) in self.scattering.iter().enumerate() {
            for (other, &column) in self.scattering.iter().enumerate() {
                sums[(row, column)] -= weight * scatter[place][other] / (scales[row] * scales[column]);
            }
            right[row] -= weight * scatter[place][SCATTERING] / scales[row];
        }
    }

    /// Sum over what has the same label of the square of what it pulls, and how many labels there are.
    fn scatter(&self, labels: &[usize], pulls: &Pulls<'_>, noise: f64) -> (DMatrix<f64>, usize) {
        let Pulls { matrix, weights, residuals, solved, scales } = *pulls;
        let unknowns = matrix.ncols();
        let mut pulls: BTreeMap<usize, DVector<f64>> = BTreeMap::new();
        for (row, label) in labels.iter().enumerate() {
            let pull = pulls.entry(*label).or_insert_with(|| DVector::zeros(unknowns));
            let weight = weights[row] / (noise * noise);
            *pull += matrix.row(row).transpose() * (weight * residuals[row]);
            // As in the sums, what scatter alone puts in is taken out.
            let Some(Scatter(scatter)) = self.scatters.get(row) else { continue };
            for (place, &unknown) in self.scattering.iter().enumerate() {
                let others = self.scattering.iter().enumerate();
                let of_others: f64 =
                    others.map(|(other, &column)| scatter[place][other] * solved[column] / scales[column]).sum();
                pull[unknown] += weight * (of_others - scatter[place][SCATTERING]) / scales[unknown];
            }
        }
        // Each has pulled the solution towards itself.
        let correction = pulls.len() as f64 / (pulls.len() as f64 - 1.0).max(1.0)
            * (self.count() as f64 / (self.count() - unknowns) as f64);
        let mut sum = DMatrix::zeros(unknowns, unknowns);
        pulls.values().for_each(|pull| sum += pull * pull.transpose() * correction);
        (sum, pulls.len())
    }
}

/// What single equations pull with.
struct Pulls<'p> {
    matrix: &'p DMatrix<f64>,
    weights: &'p DVector<f64>,
    residuals: &'p DVector<f64>,
    solved: &'p DVector<f64>,
    scales: &'p [f64],
}

impl Solution {
    /// Half of the 95 % interval of any smooth function of the unknowns, by its slopes.
    pub fn half(&self, slopes: &[(usize, f64)]) -> f64 {
        let mut slope = DVector::zeros(self.values.len());
        slopes.iter().for_each(|(unknown, by)| slope[*unknown] = *by);
        let half = |covariance: &DMatrix<f64>, reach: f64| {
            reach * (slope.transpose() * covariance * &slope)[(0, 0)].max(0.0).sqrt()
        };
        let scatter = half(&self.covariance, self.reach);
        let scatter =
            self.by_groups.as_ref().map_or(scatter, |(covariance, reach)| scatter.max(half(covariance, *reach)));
        let confounded =
            slopes.iter().filter(|(_, by)| *by != 0.0).map(|(unknown, by)| by.abs() * self.confounded[*unknown]);
        scatter + confounded.sum::<f64>()
    }

    /// Whether the equations tell an unknown apart from the others.
    pub fn tells_apart(&self, unknown: usize) -> bool {
        self.confounded[unknown] == 0.0
    }

    /// Standard deviation of an unknown.
    pub fn deviation(&self, unknown: usize) -> f64 {
        self.covariance[(unknown, unknown)].max(0.0).sqrt()
    }
}

/// Standard deviation of most of them, from the median of their sizes.
fn spread(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    1.4826 * sizes.get(sizes.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through points that scatter, a few of them far off.
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

    #[test]
    fn outliers_hardly_move_the_solution() {
        let widths = [f64::INFINITY, f64::INFINITY, 0.5];
        let solution = line(5.0).solve(&widths).expect("determined");
        assert!((solution.values[0] - 2.0).abs() < 0.01 && (solution.values[1] - 3.0).abs() < 0.01, "{solution:?}");
    }

    #[test]
    fn what_is_wrong_alike_in_a_group_widens_the_interval() {
        // Values of one kind are too large wherever in time they come.
        let mean = |grouped: bool| {
            let mut equations = Equations::default();
            for index in 0..400_usize {
                let kind = index * 7919 % 101 % 8;
                let scatter = 0.01 * ((index * 104_729 % 211) as f64 / 105.0 - 1.0);
                equations.push(vec![1.0], 1.0 + scatter + if kind == 3 { 0.02 } else { 0.0 }, index / 10);
                if grouped {
                    equations.in_group(kind);
                }
            }
            equations.solve(&[f64::INFINITY]).expect("determined").half(&[(0, 1.0)])
        };
        let [alone, grouped] = [false, true].map(mean);
        assert!(grouped > 2.0 * alone && grouped < 0.02, "{alone} {grouped}");
    }

    #[test]
    fn what_is_held_but_uncertain_widens_what_goes_with_it() {
        // The line's slope, held at three but known within a half, moves the mean by half as much.
        let mut equations = line(0.0);
        equations.values.iter_mut().zip(&equations.rows).for_each(|(value, row)| *value -= 3.0 * row[1]);
        let widths = [f64::INFINITY, 1e-9, 1e-9];
        let [alone, beside] = [vec![], vec![(1, 0.5)]]
            .map(|considered| equations.solve_considering(&widths, &considered).expect("determined"));
        assert!(alone.deviation(0) < 0.001 && alone.deviation(1) < 1e-6, "{alone:?}");
        assert!((beside.deviation(0) - 0.25).abs() < 0.005, "{}", beside.deviation(0));
        assert!((beside.deviation(1) - 0.5).abs() < 1e-6, "{}", beside.deviation(1));
    }

    #[test]
    fn what_the_equations_do_not_hold_keeps_the_width_that_was_expected() {
        let solution = line(0.0).solve(&[f64::INFINITY, f64::INFINITY, 0.5]).expect("determined");
        assert!((solution.deviation(2) - 0.5).abs() < 1e-9, "{}", solution.deviation(2));
        assert!(line(0.0).solve(&[f64::INFINITY; 3]).is_none(), "and without a width there is no solution");
    }
}

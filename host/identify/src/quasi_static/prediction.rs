//! Cross-validation: fitted on every other pass of each group, tested on the rest.

use serde::Serialize;

use super::curves::Curves;
use crate::statistics::{mean, quantile, rms};

/// Alternating fits of map and numbers.
const FIT_ROUNDS: usize = 500;

/// Residuals of three models in unseen passes, root mean square over bins [units of the output].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Prediction {
    /// Passes that were fitted.
    pub fitted: usize,
    /// Passes that were predicted.
    pub predicted: usize,
    /// Residual of a map alone.
    pub map: f64,
    /// Residual of a map and one number per group: one width, one hysteresis for each load.
    pub map_and_width: f64,
    /// Residual of a curve per group.
    pub curves: f64,
    /// Residual of the curves expected from the scatter between passes alone.
    pub repeatability: f64,
    /// Residual of the map and one number per group: mean, 10 % and 90 % quantile by bin.
    #[serde(skip)]
    pub residuals: Vec<[f64; 3]>,
    /// Systematic part of this residual in each group, by bin: known to the curves, not to one number.
    #[serde(skip)]
    pub systematic: Vec<Vec<f64>>,
}

impl Prediction {
    /// Fits and tests the models on groups of passes.
    pub fn cross_validate(curves: &Curves) -> Self {
        let every_other = |first: usize| {
            Curves(curves.0.iter().map(|group| group.iter().skip(first).step_by(2).cloned().collect()).collect())
        };
        let (seen, unseen) = (every_other(0), every_other(1));
        let means = seen.means();
        let places = means.first().map_or(0, Vec::len);
        let finite = |values: Vec<f64>| -> Vec<f64> { values.into_iter().filter(|value| value.is_finite()).collect() };
        let column = |place: usize, levels: &[f64]| -> f64 {
            let own = means.iter().zip(levels).map(|(group, level)| group[place] - level);
            mean(&finite(own.collect()))
        };
        let map: Vec<f64> = (0..places).map(|place| column(place, &vec![0.0; means.len()])).collect();
        // Least squares of a map and a number per group, for groups with missing places too.
        let (mut levels, mut common) = (vec![0.0; means.len()], map.clone());
        for _ in 0..FIT_ROUNDS {
            for (level, group) in levels.iter_mut().zip(&means) {
                *level = mean(&finite(group.iter().zip(&common).map(|(own, common)| own - common).collect()));
            }
            common = (0..places).map(|place| column(place, &levels)).collect();
        }
        let left = |predicted: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            let of = |group: usize, pass: &Vec<f64>| -> Vec<f64> {
                // All models are tested at the places of the fitted curves.
                let own = |(place, value): (usize, &f64)| {
                    if means[group][place].is_finite() { value - predicted(group, place) } else { f64::NAN }
                };
                pass.iter().enumerate().map(own).collect()
            };
            let groups = unseen.0.iter().enumerate();
            groups
                .flat_map(|(group, passes)| passes.iter().map(move |pass| of(group, pass)).collect::<Vec<_>>())
                .collect()
        };
        let of_all = |left: &[Vec<f64>]| rms(&finite(left.concat()));
        let with_width = left(&|group, place| common[place] + levels[group]);
        let by_bin = |place: usize| {
            let mut own = finite(with_width.iter().map(|pass| pass[place]).collect());
            own.sort_by(f64::total_cmp);
            [mean(&own), quantile(&own, 0.1), quantile(&own, 0.9)]
        };
        // The mean of a few fitted passes scatters too.
        let scatter = rms(&curves.deviations().values());
        let larger =
            seen.0.iter().zip(&unseen.0).map(|(seen, unseen)| unseen.len() as f64 * (1.0 + 1.0 / seen.len() as f64));
        let predicted: usize = unseen.0.iter().map(Vec::len).sum();
        Self {
            fitted: seen.0.iter().map(Vec::len).sum(),
            predicted,
            map: of_all(&left(&|_, place| map[place])),
            map_and_width: of_all(&with_width),
            curves: of_all(&left(&|group, place| means[group][place])),
            repeatability: scatter * (larger.sum::<f64>() / predicted as f64).sqrt(),
            residuals: (0..places).map(by_bin).collect(),
            systematic: means
                .iter()
                .zip(&levels)
                .map(|(group, level)| group.iter().zip(&common).map(|(own, common)| own - common - level).collect())
                .collect(),
        }
    }

    /// Residual explained by a curve per group beyond a map and one number per group.
    pub fn unexplained(&self) -> f64 {
        (self.map_and_width.powi(2) - self.curves.powi(2)).max(0.0).sqrt()
    }
}

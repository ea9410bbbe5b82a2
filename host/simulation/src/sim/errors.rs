//! Error of a motion that was computed twice: root mean square over the motion's own standard deviation, of all mesh
//! deflections together, of the gap coordinate, and of the link's offset from the rigid body, while the motion is
//! predictable. `joint sim --scheme all`, `joint check` and `joint budget` use this definition.

use serde::Serialize;

/// Relative disturbance of the torques of a second reference run, with alternating sign [-].
pub const DISTURBANCE: f64 = 1e-6;
/// Departure of the disturbed run, over a quantity's standard deviation, above which the motion is chaotic and later
/// samples do not measure a scheme [-].
pub const PREDICTABLE_DEPARTURE: f64 = 1e-3;

/// Root mean square errors over the motion's own standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Errors {
    /// All mesh deflections together.
    pub deflections: f64,
    /// Gap coordinate.
    pub gap: f64,
    /// Link angle minus that of the rigid body.
    pub link: f64,
}

impl Errors {
    /// Errors of deflections, gap and link; `None` if one of them is missing.
    pub fn from_values(values: [Option<f64>; 3]) -> Option<Self> {
        let [deflections, gap, link] = values;
        Some(Self { deflections: deflections?, gap: gap?, link: link? })
    }

    /// Greater of both errors for each quantity.
    pub fn max(self, other: Self) -> Self {
        Self {
            deflections: self.deflections.max(other.deflections),
            gap: self.gap.max(other.gap),
            link: self.link.max(other.link),
        }
    }

    /// Errors times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { deflections: factor * self.deflections, gap: factor * self.gap, link: factor * self.link }
    }

    /// Greatest of the three errors.
    pub fn greatest(&self) -> f64 {
        self.deflections.max(self.gap).max(self.link)
    }
}

/// Number of samples before the disturbed reference departs from the exact one.
pub fn predictable(exact: &[Vec<f64>], disturbed: &[Vec<f64>]) -> usize {
    let count = exact[0].len().min(disturbed[0].len());
    let left = |exact: &[f64], disturbed: &[f64]| {
        let bound = PREDICTABLE_DEPARTURE * standard_deviation(&exact[..count]);
        exact.iter().zip(disturbed).take(count).position(|(a, b)| (a - b).abs() > bound).unwrap_or(count)
    };
    exact.iter().zip(disturbed).map(|(exact, disturbed)| left(exact, disturbed)).min().unwrap_or(0)
}

/// Errors of a scheme over the predictable samples; `None` for a quantity that does not move, or if the scheme ended
/// early.
pub fn errors(exact: &[Vec<f64>], columns: &[Vec<f64>], predictable: usize) -> [Option<f64>; 3] {
    let meshes = exact.len() - 2;
    let relative = |place: usize| {
        let count = predictable.min(columns[place].len());
        let exact = &exact[place][..count];
        let square: f64 = exact.iter().zip(&columns[place]).map(|(a, b)| (a - b).powi(2)).sum();
        let error = (square / count as f64).sqrt() / standard_deviation(exact);
        (count == predictable && error.is_finite()).then_some(error)
    };
    let deflections: Option<Vec<f64>> = (0..meshes).map(relative).collect();
    let together = deflections.map(|all| (all.iter().map(|e| e * e).sum::<f64>() / meshes as f64).sqrt());
    [together, relative(meshes), relative(meshes + 1)]
}

/// Standard deviation over the greatest value up to which a quantity counts as constant [-]. Rounding of f32 is 6e-8 of
/// a value, and the steps of the reference move a constant by less.
const CONSTANT_SPREAD: f64 = 1e-6;

/// Returns true if a quantity is constant.
pub fn is_constant(values: &[f64]) -> bool {
    let greatest = values.iter().fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
    standard_deviation(values) <= CONSTANT_SPREAD * greatest
}

/// Standard deviation.
pub fn standard_deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

//! Result of a sweep as numbers on its grid, for the pictures.

use super::grid::Grid;
use super::manifest::Manifest;
use super::metrics::Metric;
use super::points::Points;

/// Status of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// The point has values.
    Whole,
    /// The scheme diverged.
    Diverged,
    /// The joint file rejects the point's joint.
    Refused,
}

/// An axis with its values as numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberedAxis<'g> {
    /// Key.
    pub key: &'g str,
    /// Values as typed.
    pub words: &'g [String],
    /// Values as numbers; indices from 1 if a value is not a number, or if the values are not monotonic.
    pub values: Vec<f64>,
    /// True if the values are indices.
    pub by_index: bool,
    /// Points from one value to the next.
    stride: u64,
}

/// All points.
pub struct SweepTable<'g> {
    /// Axes in the order of the command line.
    pub axes: Vec<NumberedAxis<'g>>,
    /// Columns.
    pub metrics: &'g [Metric],
    /// Status of each point.
    pub status: Vec<Status>,
    /// Values of each metric; NaN if missing.
    pub values: Vec<Vec<f64>>,
}

impl<'g> NumberedAxis<'g> {
    fn new(key: &'g str, words: &'g [String], stride: u64) -> Self {
        let numbers: Option<Vec<f64>> =
            words.iter().map(|word| word.parse::<f64>().ok().filter(|value| value.is_finite())).collect();
        let in_order = |values: &Vec<f64>| {
            values.windows(2).all(|pair| pair[0] < pair[1]) || values.windows(2).all(|pair| pair[0] > pair[1])
        };
        let numbers = numbers.filter(in_order);
        let by_index = numbers.is_none();
        let values = numbers.unwrap_or_else(|| (1..=words.len()).map(|place| place as f64).collect());
        Self { key, words, values, by_index, stride }
    }

    /// Index of a point on this axis.
    pub fn index(&self, point: usize) -> usize {
        point / self.stride as usize % self.words.len()
    }

    /// Rising edges of the cells around the values, half-way between neighbours; one more than there are values.
    pub fn edges(&self) -> Vec<f64> {
        let mut values = self.values.clone();
        values.sort_by(f64::total_cmp);
        let (first, last) = (values[0], values[values.len() - 1]);
        let half = |a: f64, b: f64| 0.5 * (b - a);
        let (before, after) = match values.as_slice() {
            [one] => (0.05 * one.abs().max(1.0), 0.05 * one.abs().max(1.0)),
            [.., y, z] => (half(values[0], values[1]), half(*y, *z)),
            [] => (0.5, 0.5),
        };
        let between = values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        std::iter::once(first - before).chain(between).chain([last + after]).collect()
    }

    /// Index of the cell of a value; the axis may fall.
    pub fn cell(&self, place: usize) -> usize {
        let falls = self.values.first() > self.values.last();
        if falls { self.values.len() - 1 - place } else { place }
    }
}

impl<'g> SweepTable<'g> {
    /// Table from the rows of a result.
    pub fn from_points(manifest: &'g Manifest, grid: &'g Grid, points: &Points) -> Self {
        let mut stride = grid.points;
        let axes = grid.axes.iter().map(|axis| {
            stride /= axis.values.len() as u64;
            NumberedAxis::new(&axis.key, &axis.values, stride)
        });
        let axes = axes.collect();
        let mut status = Vec::with_capacity(points.len());
        let mut values = vec![Vec::with_capacity(points.len()); manifest.metrics.len()];
        for result in points.values() {
            let mut cells = result.split(',');
            status.push(match cells.next() {
                Some("ok") => Status::Whole,
                Some("diverged") => Status::Diverged,
                _ => Status::Refused,
            });
            for column in &mut values {
                column.push(cells.next().and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN));
            }
        }
        Self { axes, metrics: &manifest.metrics, status, values }
    }

    /// Number of points with a status.
    pub fn count(&self, wanted: Status) -> usize {
        self.status.iter().filter(|status| **status == wanted).count()
    }

    /// Position of a point as text: keys by their last part, if it is unique.
    pub fn position_text(&self, point: usize) -> String {
        let last = |key: &'g str| key.rsplit('.').next().unwrap_or(key);
        let name = |key: &'g str| {
            let alone = self.axes.iter().filter(|axis| last(axis.key) == last(key)).count() == 1;
            if alone { last(key) } else { key }
        };
        let axis = |axis: &NumberedAxis<'g>| format!("{} = {}", name(axis.key), axis.words[axis.index(point)]);
        self.axes.iter().map(axis).collect::<Vec<_>>().join(", ")
    }

    /// Points of the least and the greatest value of a column.
    pub fn extremes(&self, column: usize) -> Option<[usize; 2]> {
        let values = &self.values[column];
        let finite = || (0..values.len()).filter(|point| values[*point].is_finite());
        let least = finite().min_by(|a, b| values[*a].total_cmp(&values[*b]))?;
        let most = finite().max_by(|a, b| values[*a].total_cmp(&values[*b]).then(b.cmp(a)))?;
        Some([least, most])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_lie_halfway_between_values() {
        let words: Vec<String> = ["30", "10", "0"].map(str::to_owned).to_vec();
        let axis = NumberedAxis::new("a", &words, 1);
        assert_eq!(axis.edges(), [-5.0, 5.0, 20.0, 40.0]);
        assert_eq!([0, 1, 2].map(|place| axis.cell(place)), [2, 1, 0]);
        let words: Vec<String> = ["sharp", "tanh"].map(str::to_owned).to_vec();
        let axis = NumberedAxis::new("a", &words, 1);
        assert!(axis.by_index);
        assert_eq!(axis.edges(), [0.5, 1.5, 2.5]);
    }
}

//! Groups of repeated curves, and intervals of figures of their means.

use crate::estimate::Estimate;
use crate::statistics::{mean, rms, student};
use scenario::random::RandomStream;

/// Random draws for an interval if some places have a single repeat.
const DRAWS: usize = 400;

/// Curves over common places: group, repeat, place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curves(pub Vec<Vec<Vec<f64>>>);

impl Curves {
    /// Mean curve of each group; places missing in a repeat are NaN and skipped.
    pub fn means(&self) -> Vec<Vec<f64>> {
        self.0.iter().map(|group| Sums::new(group).means()).collect()
    }

    /// Returns true if every group has two repeats at every place.
    fn is_repeated(&self) -> bool {
        self.0.iter().all(|group| Sums::new(group).counts.iter().all(|count| *count >= 2.0))
    }

    /// Figure of the means with its 95 % interval: by the jackknife over repeats or, if some places have a single
    /// repeat, by draws from the scatter of the other places.
    pub fn estimate(&self, figure: impl Fn(&[Vec<f64>]) -> f64) -> Estimate {
        if self.is_repeated() {
            self.without_each(figure)
        } else {
            RepeatScatter::from_curves(self).estimate(self, figure)
        }
    }

    /// Figure at each place with its 95 % interval.
    pub fn estimates(&self, figure: impl Fn(&[Vec<f64>], usize) -> f64) -> Vec<Estimate> {
        let places = self.0.iter().flatten().next().map_or(0, Vec::len);
        if self.is_repeated() {
            return (0..places).map(|place| self.at(place).without_each(|means| figure(means, 0))).collect();
        }
        let means = self.means();
        let scatter = RepeatScatter::from_curves(self);
        let draws = scatter.draws(self);
        (0..places)
            .map(|place| {
                let drawn: Vec<f64> = draws.iter().map(|means| figure(means, place)).collect();
                scatter.about(figure(&means, place), &drawn)
            })
            .collect()
    }

    fn without_each(&self, figure: impl Fn(&[Vec<f64>]) -> f64) -> Estimate {
        let mut means = self.means();
        let value = figure(&means);
        let (mut variance, mut over_freedom) = (0.0, 0.0);
        for (index, group) in self.0.iter().enumerate() {
            let sums = Sums::new(group);
            let without: Vec<f64> = group
                .iter()
                .map(|left_out| {
                    means[index] = sums.means_without(left_out);
                    figure(&means)
                })
                .collect();
            means[index] = sums.means();
            let count = group.len() as f64;
            let middle = mean(&without);
            let own = (count - 1.0) / count * without.iter().map(|one| (one - middle).powi(2)).sum::<f64>();
            variance += own;
            over_freedom += own * own / (count - 1.0);
        }
        // Satterthwaite's degrees of freedom.
        let freedom = if over_freedom > 0.0 { variance * variance / over_freedom } else { 1.0 };
        Estimate { value, half: student(freedom) * variance.sqrt() }
    }

    /// Curves at one place, from the repeats that have it.
    fn at(&self, place: usize) -> Self {
        let own = |group: &Vec<Vec<f64>>| {
            group.iter().map(|curve| curve[place]).filter(|value| value.is_finite()).map(|value| vec![value]).collect()
        };
        Self(self.0.iter().map(own).collect())
    }

    /// Deviations of every repeat from its group's mean, scaled up for the few repeats in the mean: group, repeat,
    /// place.
    pub fn deviations(&self) -> Self {
        let of = |group: &Vec<Vec<f64>>| {
            let Sums { sums, counts } = Sums::new(group);
            let deviation = |(place, value): (usize, &f64)| {
                let count = counts[place];
                (value - sums[place] / count) * (count / (count - 1.0)).sqrt()
            };
            group.iter().map(|one| one.iter().enumerate().map(deviation).collect()).collect()
        };
        Self(self.0.iter().map(of).collect())
    }

    /// All finite values.
    pub fn values(&self) -> Vec<f64> {
        self.0.iter().flatten().flatten().copied().filter(|value| value.is_finite()).collect()
    }
}

/// Scatter of repeats, from the places with several.
struct RepeatScatter {
    /// Standard deviation of the repeats' means.
    whole: f64,
    /// Standard deviation along a repeat, about its mean.
    along: f64,
    /// Correlation between neighbouring places of a repeat.
    common: f64,
    /// Degrees of freedom.
    freedom: f64,
}

impl RepeatScatter {
    fn from_curves(curves: &Curves) -> Self {
        let deviations = curves.deviations();
        let (mut means, mut rests, mut products, mut freedom) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
        for group in &deviations.0 {
            let mut count = 0.0_f64;
            for curve in group {
                let there: Vec<f64> = curve.iter().copied().filter(|value| value.is_finite()).collect();
                if there.is_empty() {
                    continue;
                }
                count += 1.0;
                let middle = mean(&there);
                means.push(middle);
                rests.extend(there.iter().map(|value| value - middle));
                products.extend(there.windows(2).map(|pair| (pair[0] - middle) * (pair[1] - middle)));
            }
            freedom += (count - 1.0).max(0.0);
        }
        let along = rms(&rests);
        let common = if along > 0.0 { (mean(&products) / (along * along)).clamp(0.0, 0.99) } else { 0.0 };
        Self { whole: rms(&means), along, common, freedom }
    }

    /// Random means of the groups.
    fn draws(&self, curves: &Curves) -> Vec<Vec<Vec<f64>>> {
        let mut random = RandomStream::new(1, "repeats");
        let means = curves.means();
        let one = |random: &mut RandomStream| -> Vec<Vec<f64>> {
            let groups = curves.0.iter().zip(&means);
            groups
                .map(|(group, means)| {
                    let shifted: Vec<Vec<f64>> = group.iter().map(|curve| self.draw(curve, random)).collect();
                    Sums::new(&shifted).means().iter().zip(means).map(|(shift, mean)| mean + shift).collect()
                })
                .collect()
        };
        (0..DRAWS).map(|_| one(&mut random)).collect()
    }

    /// Random deviation of one repeat, at the places it has.
    fn draw(&self, curve: &[f64], random: &mut RandomStream) -> Vec<f64> {
        let whole = self.whole * random.normal();
        let mut along = self.along * random.normal();
        let mut next = |value: &f64| {
            let shift = whole + along;
            along = self.common * along + (1.0 - self.common * self.common).sqrt() * self.along * random.normal();
            if value.is_finite() { shift } else { f64::NAN }
        };
        curve.iter().map(&mut next).collect()
    }

    fn estimate(&self, curves: &Curves, figure: impl Fn(&[Vec<f64>]) -> f64) -> Estimate {
        let drawn: Vec<f64> = self.draws(curves).iter().map(|means| figure(means)).collect();
        self.about(figure(&curves.means()), &drawn)
    }

    fn about(&self, value: f64, drawn: &[f64]) -> Estimate {
        let middle = mean(drawn);
        let about: Vec<f64> = drawn.iter().map(|one| one - middle).collect();
        Estimate { value, half: student(self.freedom.max(1.0)) * rms(&about) }
    }
}

/// Sums and counts by place, over the repeats that have it.
struct Sums {
    sums: Vec<f64>,
    counts: Vec<f64>,
}

impl Sums {
    fn new(group: &[Vec<f64>]) -> Self {
        let places = group.first().map_or(0, Vec::len);
        let (mut sums, mut counts) = (vec![0.0; places], vec![0.0; places]);
        for curve in group {
            for (place, value) in curve.iter().enumerate().filter(|(_, value)| value.is_finite()) {
                sums[place] += value;
                counts[place] += 1.0;
            }
        }
        Self { sums, counts }
    }

    fn means(&self) -> Vec<f64> {
        self.sums.iter().zip(&self.counts).map(|(sum, count)| sum / count).collect()
    }

    fn means_without(&self, curve: &[f64]) -> Vec<f64> {
        let mean = |(place, value): (usize, &f64)| match value.is_finite() {
            true => (self.sums[place] - value) / (self.counts[place] - 1.0),
            false => self.sums[place] / self.counts[place],
        };
        curve.iter().enumerate().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The interval of a difference of two means is Welch's.
    #[test]
    fn jackknife_interval_equals_welch() {
        let group = |values: &[f64]| values.iter().map(|value| vec![*value]).collect::<Vec<_>>();
        let curves = Curves(vec![group(&[1.0, 2.0, 3.0, 4.0]), group(&[10.0, 12.0, 11.0])]);
        let found = curves.estimate(|means| means[1][0] - means[0][0]);
        // Variances of the means 5/12 and 1/3, degrees of freedom (3/4)^2 / ((5/12)^2/3 + (1/3)^2/2).
        let freedom = 0.5625 / ((25.0 / 144.0) / 3.0 + (1.0 / 9.0) / 2.0);
        assert!((found.value - 8.5).abs() < 1e-12);
        assert!((found.half - student(freedom) * 0.75_f64.sqrt()).abs() < 1e-12, "{found:?}");
    }

    /// Places with a single repeat use the scatter of the other places.
    #[test]
    fn single_repeat_uses_scatter_of_others() {
        let mut random = RandomStream::new(3, "test");
        let mut group = |count: usize| -> Vec<Vec<f64>> { (0..count).map(|_| vec![random.normal(); 40]).collect() };
        let whole = Curves(vec![group(12), group(12)]);
        let figure = |means: &[Vec<f64>]| mean(&means[1]) - mean(&means[0]);
        let known = whole.estimate(figure);
        let mut holed = whole;
        holed.0[0].iter_mut().skip(1).for_each(|curve| curve[0] = f64::NAN);
        let taken = holed.estimate(figure);
        assert!((taken.half / known.half - 1.0).abs() < 0.2, "{known:?} {taken:?}");
        // With one repeat instead of twelve in the first group, its own scatter counts.
        holed.0[0].iter_mut().skip(1).for_each(|curve| curve[1..].fill(f64::NAN));
        let single = holed.estimate(figure);
        assert!((single.half / (13.0 / 2.0_f64).sqrt() / known.half - 1.0).abs() < 0.35, "{known:?} {single:?}");
    }
}

//! Profiles of the passes: means of difference and torques over common bins of the output.

use super::passes::Pass;
use super::samples::Samples;
use crate::statistics::{mean, quantile_of};
use report::failure::{Failure, Outcome};

/// Samples of a typical pass per bin.
const SAMPLES_PER_BIN: f64 = 6.0;
/// Least and largest number of bins.
const BIN_COUNT_RANGE: (f64, f64) = (12.0, 120.0);
/// Least number of bins shared by all groups.
pub const BINS_MIN: usize = 8;
/// Least passes of each direction in a bin.
pub const PASSES_MIN: usize = 2;

/// One pass over the bins.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The pass.
    pub pass: Pass,
    /// Mean difference in each bin; NaN unless the pass covers the whole bin.
    pub difference: Vec<f64>,
    /// Mean motor torque in each bin, if logged [N m].
    pub motor_torque: Option<Vec<f64>>,
    /// Mean torque of the joint on its link in each bin, if logged [N m].
    pub output_torque: Option<Vec<f64>>,
    /// First, middle and last time [s].
    pub time: [f64; 3],
    /// Mean speed of the motor on the output's scale [units/s].
    pub speed: f64,
    /// Sum of squares of single readings about their bin's mean, and its degrees of freedom.
    pub scatter: (f64, f64),
}

/// Bins and the passes over them.
#[derive(Debug, Clone, PartialEq)]
pub struct Profiles {
    /// Middle of each bin [units of the output].
    pub places: Vec<f64>,
    /// Width of a bin.
    pub width: f64,
    /// Every pass that covers a bin, in order of time.
    pub all: Vec<Profile>,
}

impl Profiles {
    /// Profiles over the places that passes of each direction, in each half, cover.
    pub fn from_passes(samples: &Samples, passes: &[Pass], halves: usize) -> Outcome<Self> {
        let (mut low, mut high) = (f64::MIN, f64::MAX);
        for half in 0..halves.max(1) {
            for forwards in [true, false] {
                let own = passes.iter().filter(|pass| pass.half == half && pass.forwards == forwards);
                let ends: Vec<(f64, f64)> = own.map(|pass| range(&samples.output[pass.range.clone()])).collect();
                check_count(ends.len(), half, halves, forwards)?;
                low = low.max(ends.iter().map(|ends| ends.0).fold(f64::MAX, f64::min));
                high = high.min(ends.iter().map(|ends| ends.1).fold(f64::MIN, f64::max));
            }
        }
        if low >= high {
            return Err(no_common_places());
        }
        let inside = |pass: &Pass| {
            let places = samples.output[pass.range.clone()].iter();
            places.filter(|place| (low..=high).contains(*place)).count() as f64
        };
        let counts: Vec<f64> = passes.iter().map(inside).collect();
        let count = (quantile_of(&counts, 0.5) / SAMPLES_PER_BIN).floor().clamp(BIN_COUNT_RANGE.0, BIN_COUNT_RANGE.1);
        let width = (high - low) / count;
        let bins = Bins { low, width, count: count as usize };
        let all: Vec<Profile> = passes.iter().map(|pass| profile(samples, pass, &bins)).collect();
        let places = (0..bins.count).map(|bin| low + (bin as f64 + 0.5) * width).collect();
        let all = all.into_iter().filter(|one| one.difference.iter().any(|value| value.is_finite())).collect();
        Ok(Self { places, width, all })
    }

    /// Keeps the bins that every group has; every group must have been twice in enough of them.
    pub fn shared(mut self, group: impl Fn(&Profile) -> usize, groups: usize) -> Outcome<Self> {
        let count = |bin: usize, wanted: usize| {
            self.all.iter().filter(|one| group(one) == wanted && one.difference[bin].is_finite()).count()
        };
        let keep: Vec<bool> =
            (0..self.places.len()).map(|bin| (0..groups).all(|group| count(bin, group) > 0)).collect();
        let repeated =
            |group: usize| (0..keep.len()).filter(|bin| keep[*bin] && count(*bin, group) >= PASSES_MIN).count();
        if (0..groups).any(|group| repeated(group) < BINS_MIN) {
            return Err(no_common_places());
        }
        let kept = |values: &[f64]| -> Vec<f64> {
            values.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(value, _)| *value).collect()
        };
        self.places = kept(&self.places);
        for one in &mut self.all {
            one.difference = kept(&one.difference);
            for torque in [&mut one.motor_torque, &mut one.output_torque].into_iter().flatten() {
                *torque = kept(torque);
            }
        }
        Ok(self)
    }

    /// Root mean square of single readings about their bin's mean [units of the output].
    pub fn scatter(&self) -> f64 {
        let (sum, free) =
            self.all.iter().fold((0.0, 0.0), |(sum, free), one| (sum + one.scatter.0, free + one.scatter.1));
        (sum / free).sqrt()
    }

    /// Median speed [units of the output/s].
    pub fn speed(&self) -> f64 {
        quantile_of(&self.all.iter().map(|one| one.speed).collect::<Vec<_>>(), 0.5)
    }
}

impl Profile {
    /// Mean of the finite values.
    pub fn mean(values: &[f64]) -> f64 {
        mean(&values.iter().copied().filter(|value| value.is_finite()).collect::<Vec<_>>())
    }
}

/// Rejects too few passes for an interval.
pub fn check_count(count: usize, half: usize, halves: usize, forwards: bool) -> Outcome<()> {
    if count >= PASSES_MIN {
        return Ok(());
    }
    let way = if forwards { "forwards" } else { "backwards" };
    let place = match halves {
        0 => String::new(),
        _ => format!(" in the {} half", ["first", "second"][half.min(1)]),
    };
    Err(Failure::new(format!("too few passes: {count} {way}{place}, {PASSES_MIN} each way are the least")).with_help(
        "sweep slowly over the same places at least twice in each direction; the intervals come from the \
             scatter between passes",
    ))
}

fn no_common_places() -> Failure {
    Failure::new(
        "the passes do not cover the same places: fewer than eight places have all kinds of passes and a \
             repeat",
    )
    .with_help("sweep to and fro between the same places, in each half of the log")
}

struct Bins {
    low: f64,
    width: f64,
    count: usize,
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)))
}

fn profile(samples: &Samples, pass: &Pass, bins: &Bins) -> Profile {
    let own = pass.range.clone();
    let (low, high) = range(&samples.output[own.clone()]);
    // Rounding may end a pass just before the end of a bin.
    let slack = 1e-9 * bins.width;
    let whole = |bin: usize| {
        let from = bins.low + bin as f64 * bins.width;
        low <= from + slack && high >= from + bins.width - slack
    };
    let bin = |sample: usize| {
        let place = ((samples.output[sample] - bins.low) / bins.width).floor();
        (place >= 0.0 && place < bins.count as f64).then_some(place as usize)
    };
    let means = |values: &[f64]| -> Vec<f64> {
        let (mut sums, mut counts) = (vec![0.0; bins.count], vec![0.0; bins.count]);
        for (sample, bin) in own.clone().filter_map(|sample| Some((sample, bin(sample)?))) {
            sums[bin] += values[sample];
            counts[bin] += 1.0;
        }
        let mean = |bin: usize| if whole(bin) { sums[bin] / counts[bin] } else { f64::NAN };
        (0..bins.count).map(mean).collect()
    };
    let difference = means(&samples.difference);
    let (mut squares, mut readings) = (0.0, 0.0);
    for (sample, bin) in own.clone().filter_map(|sample| Some((sample, bin(sample)?))) {
        if difference[bin].is_finite() {
            squares += (samples.difference[sample] - difference[bin]).powi(2);
            readings += 1.0;
        }
    }
    let bins_there = difference.iter().filter(|value| value.is_finite()).count() as f64;
    let (first, last) = (samples.time[own.start], samples.time[own.end - 1]);
    Profile {
        motor_torque: samples.motor_torque.as_deref().map(means),
        output_torque: samples.output_torque.as_deref().map(means),
        time: [first, 0.5 * (first + last), last],
        speed: (samples.motor[own.end - 1] - samples.motor[own.start]).abs() / (last - first),
        scatter: (squares, (readings - bins_there).max(0.0)),
        difference,
        pass: pass.clone(),
    }
}

//! Even times for a log with lost samples or uneven time steps; derivatives need even steps.
//!
//! Steps much longer than the usual one are holes: no moment near a hole is used. Between holes either the stamps are
//! right, and values at even times are interpolated; or the samples were taken evenly and only the stamps vary, as
//! those of a receiving host do. The motor decides: its motion is smoother under the right assumption.

use super::columns::Columns;
use super::noise::Noise;
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// Step, in usual steps, from which it is a hole.
const HOLE: f64 = 1.75;
/// Root mean square variation below which steps are even, relative to a step: rounding of stamps is above it.
const EVEN: f64 = 1e-3;
/// Least share of a log's samples that are present.
const THERE: f64 = 0.8;
/// Least samples between two holes for these samples to be used.
const LEAST: usize = 8;
/// Interpolation reduces the variance of readings to no less than this share; stamps are trusted if the motion is
/// smoother than that.
const SMOOTHED: f64 = 0.5;

/// Source of a value at an even time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Sample by its index.
    Sample(usize),
    /// Four samples from this index on, with their weights.
    Between(usize, [f64; 4]),
    /// Lost: index of the sample before, and share of the way to the next.
    Lost(usize, f64),
}

/// Even times, and the source of each value.
#[derive(Debug, Clone, PartialEq)]
pub struct EvenTimes {
    /// Time between even times [s].
    pub period: f64,
    places: Vec<Place>,
    /// Usual steps before each sample: 1, or more behind a hole.
    steps: Vec<f64>,
    /// Lost places before each place, and in total.
    lost: Vec<usize>,
    /// Note on changes to the samples.
    pub told: Option<String>,
}

impl EvenTimes {
    /// Even times of samples whose times begin at zero.
    pub fn new(time: &[f64], columns: &Columns) -> Outcome<Self> {
        let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(row) = steps.iter().position(|&step| step <= 0.0) {
            return Err(Failure::new(format!("the time does not rise in {}", columns.place(row + 1)))
                .with_help("samples must be in the order in which they were taken, each with its own time"));
        }
        let mut sorted = steps.clone();
        sorted.sort_by(f64::total_cmp);
        let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
        let is_hole = |step: f64| step > HOLE * usual;
        let within: Vec<f64> = steps.iter().copied().filter(|step| !is_hole(*step)).collect();
        let period = within.iter().sum::<f64>() / within.len().max(1) as f64;
        let holes: f64 = steps.iter().filter(|step| is_hole(**step)).map(|step| step / period - 1.0).sum();
        if holes > (1.0 - THERE) * (holes + time.len() as f64) {
            let first = steps.iter().position(|step| is_hole(*step)).unwrap_or_default();
            let share = 100.0 * holes / (holes + time.len() as f64);
            return Err(Failure::new(format!(
                "samples are far from evenly spaced: {share:.0} % of them are lost, first before {} with {} s where {} s are \
                 usual",
                columns.place(first + 1),
                ESTIMATE.write(steps[first]),
                ESTIMATE.write(usual)
            ))
            .with_help("record so that every sample arrives, or cut the log to where they do"));
        }
        let steps: Vec<f64> = std::iter::once(1.0)
            .chain(steps.iter().map(|&step| if is_hole(step) { (step / period).round() } else { 1.0 }))
            .collect();
        Ok(Self::by_count(period, steps))
    }

    /// Even samples without holes.
    #[cfg(test)]
    pub fn of_even(period: f64, samples: usize) -> Self {
        Self::by_count(period, vec![1.0; samples])
    }

    /// Assumes evenly taken samples, whatever their stamps.
    fn by_count(period: f64, steps: Vec<f64>) -> Self {
        let mut places = Vec::with_capacity(steps.len());
        for (row, &step) in steps.iter().enumerate() {
            let lost = (1..step as usize).map(|place| Place::Lost(row - 1, place as f64 / step));
            places.extend(lost);
            places.push(Place::Sample(row));
        }
        Self::with(period, places, steps)
    }

    /// Assumes samples taken at their stamps; `time` begins at zero.
    fn by_stamps(&self, time: &[f64]) -> Self {
        let period = self.period;
        let last = time.last().copied().unwrap_or_default();
        let mut places = Vec::new();
        let mut row = 0;
        for place in 0..=(last / period) as usize {
            let now = place as f64 * period;
            while row + 2 < time.len() && time[row + 1] <= now {
                row += 1;
            }
            // Four samples around the time without a hole between them, shifted inwards next to a hole.
            let whole = |from: &usize| self.steps[from + 1..from + 4].iter().all(|step| *step == 1.0);
            let from = [row.saturating_sub(1), row, row.saturating_sub(2)]
                .into_iter()
                .filter(|from| from + 4 <= time.len() && from + 3 > row)
                .find(whole);
            places.push(match from {
                Some(from) if self.steps[row + 1] == 1.0 => Place::Between(from, weights(&time[from..from + 4], now)),
                _ => Place::Lost(row, ((now - time[row]) / (time[row + 1] - time[row])).clamp(0.0, 1.0)),
            });
        }
        Self::with(period, places, self.steps.clone())
    }

    /// Counts the lost places; short stretches between holes count as lost.
    fn with(period: f64, mut places: Vec<Place>, steps: Vec<f64>) -> Self {
        let mut from = 0;
        while from < places.len() {
            let is_lost = |place: &Place| matches!(place, Place::Lost(..));
            let end = (from..places.len()).find(|place| is_lost(&places[*place])).unwrap_or(places.len());
            if end - from < LEAST {
                for place in &mut places[from..end] {
                    if let Place::Sample(row) | Place::Between(row, _) = *place {
                        *place = Place::Lost(row.min(steps.len().saturating_sub(2)), 0.0);
                    }
                }
            }
            from = (end..places.len()).find(|place| !is_lost(&places[*place])).unwrap_or(places.len());
        }
        let count = |sum: &mut usize, place: &Place| {
            let before = *sum;
            *sum += usize::from(matches!(place, Place::Lost(..)));
            Some(before)
        };
        let mut lost: Vec<usize> = places.iter().scan(0, count).collect();
        lost.push(places.iter().filter(|place| matches!(place, Place::Lost(..))).count());
        Self { period, places, steps, lost, told: None }
    }

    /// Chooses evenly taken samples or the stamps, by the smoother motion; `time` begins at zero.
    pub fn smoother(self, time: &[f64], motion: &[f64]) -> Self {
        let within = |pair: &[f64]| (pair[1] - pair[0]) / self.period;
        let usual: Vec<f64> = time.windows(2).map(within).filter(|step| *step <= HOLE).collect();
        let square = usual.iter().map(|step| (step - 1.0).powi(2)).sum::<f64>() / usual.len().max(1) as f64;
        let jitter = square.sqrt();
        if jitter < EVEN {
            return Self { told: self.told(0.0, None), ..self };
        }
        let stamped = self.by_stamps(time);
        let scatter = |times: &Self| Noise::of(&times.bring(motion), |from, to| times.is_whole(from, to)).mean();
        if scatter(&stamped) < SMOOTHED * scatter(&self) {
            Self { told: stamped.told(jitter, Some("interpolated to even times by their stamps")), ..stamped }
        } else {
            Self {
                told: self.told(jitter, Some("taken for even: the motor's motion is as smooth so as by the stamps")),
                ..self
            }
        }
    }

    /// Note on lost samples and stamps, for the report.
    fn told(&self, jitter: f64, done: Option<&str>) -> Option<String> {
        let lost = self.lost.last().copied().unwrap_or_default();
        let holes = self.steps.iter().filter(|step| **step > 1.0).count();
        let of_holes =
            format!("{lost} of {} samples lost in {holes} holes: nothing near them is used.", self.places.len());
        let of_stamps = |done: &str| format!("Times between samples vary by {:.1} % (rms): {done}.", 100.0 * jitter);
        let parts: Vec<String> = (lost > 0).then_some(of_holes).into_iter().chain(done.map(of_stamps)).collect();
        (!parts.is_empty()).then(|| parts.join(" "))
    }

    /// Even times [s].
    pub fn times(&self) -> Vec<f64> {
        (0..self.places.len()).map(|place| place as f64 * self.period).collect()
    }

    /// Values at the even times, from values of the samples.
    pub fn bring(&self, values: &[f64]) -> Vec<f64> {
        let bring = |place: &Place| match *place {
            Place::Sample(row) => values[row],
            // Differences to one sample keep their digits after many turns.
            Place::Between(from, weights) => {
                let apart = weights.iter().zip(&values[from..]).map(|(weight, value)| weight * (value - values[from]));
                values[from] + apart.sum::<f64>()
            }
            Place::Lost(row, share) => values[row] + share * (values[row + 1] - values[row]),
        };
        self.places.iter().map(bring).collect()
    }

    /// Returns true if nothing is lost from one place up to another, excluding the latter.
    pub fn is_whole(&self, from: usize, to: usize) -> bool {
        let at = |place: usize| self.lost[place.min(self.places.len())];
        at(from) == at(to)
    }

    /// Usual time steps before a sample: 1, or more behind a hole.
    pub fn periods_before(&self, row: usize) -> f64 {
        self.steps.get(row).copied().unwrap_or(1.0)
    }

    /// Divides the steps over holes by the number of usual time steps.
    pub fn per_period(&self, mut steps: Vec<f64>) -> Vec<f64> {
        steps.iter_mut().enumerate().for_each(|(row, step)| *step /= self.periods_before(row + 1));
        steps
    }
}

/// Weights of four values at these times for the value at another time (Lagrange).
fn weights(times: &[f64], now: f64) -> [f64; 4] {
    std::array::from_fn(|one| {
        let others = (0..4).filter(|other| *other != one);
        others.map(|other| (now - times[other]) / (times[one] - times[other])).product()
    })
}

#[cfg(test)]
mod tests {
    use super::EvenTimes;

    const PERIOD: f64 = 1e-4;

    /// Times that vary by a fifth of a period, without accumulating.
    fn jittering(samples: usize) -> Vec<f64> {
        let turn = |row: usize| (row as f64 * 2.399).sin();
        (0..samples).map(|row| if row == 0 { 0.0 } else { PERIOD * (row as f64 + 0.2 * turn(row)) }).collect()
    }

    fn motion(time: f64) -> f64 {
        3.0 * (200.0 * time).sin() + 40.0 * time
    }

    fn even(time: &[f64], motion: &[f64]) -> EvenTimes {
        let steps = vec![1.0; time.len()];
        EvenTimes::by_count(PERIOD, steps).smoother(time, motion)
    }

    #[test]
    fn samples_that_were_taken_when_their_stamps_say_are_interpolated() {
        let time = jittering(2000);
        let motion: Vec<f64> = time.iter().map(|time| self::motion(*time)).collect();
        let times = even(&time, &motion);
        assert!(times.told.as_deref().is_some_and(|told| told.contains("interpolated")), "{:?}", times.told);
        for (time, value) in times.times().iter().zip(times.bring(&motion)).skip(2).take(1990) {
            assert!((value - self::motion(*time)).abs() < 1e-7, "{time}: {value}");
        }
    }

    #[test]
    fn samples_that_were_taken_evenly_stay_as_they_are_whatever_their_stamps_say() {
        let motion: Vec<f64> = (0..2000).map(|row| self::motion(row as f64 * PERIOD)).collect();
        let times = even(&jittering(2000), &motion);
        assert!(times.told.as_deref().is_some_and(|told| told.contains("taken for even")), "{:?}", times.told);
        assert_eq!(times.bring(&motion), motion);
    }

    #[test]
    fn a_hole_keeps_its_length_and_is_known_as_one() {
        let mut steps = vec![1.0; 100];
        steps[50] = 4.0;
        let times = EvenTimes::by_count(PERIOD, steps);
        let brought = times.bring(&(0..100).map(f64::from).collect::<Vec<f64>>());
        assert_eq!(brought.len(), 103);
        assert!(times.is_whole(0, 50) && !times.is_whole(49, 51) && times.is_whole(53, 103));
        assert_eq!((brought[49], brought[51], brought[53]), (49.0, 49.5, 50.0));
    }
}

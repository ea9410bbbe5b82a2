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
const HOLE_STEPS: f64 = 1.75;
/// Root mean square variation below which steps are even, relative to a step: rounding of stamps is above it.
const EVEN_JITTER: f64 = 1e-3;
/// Least share of a log's samples that are present.
const PRESENT_SHARE_MIN: f64 = 0.8;
/// Least samples between two holes for these samples to be used.
const STRETCH_SAMPLES_MIN: usize = 8;
/// Interpolation reduces the variance of readings to no less than this share; stamps are trusted if the motion is
/// smoother than that.
const INTERPOLATION_VARIANCE: f64 = 0.5;

/// Source of a value at an even time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ValueSource {
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
    sources: Vec<ValueSource>,
    /// Usual steps before each sample: 1, or more behind a hole.
    steps: Vec<f64>,
    /// Lost places before each place, and in total.
    lost: Vec<usize>,
    /// Note on changes to the samples.
    pub note: Option<String>,
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
        let is_hole = |step: f64| step > HOLE_STEPS * usual;
        let within: Vec<f64> = steps.iter().copied().filter(|step| !is_hole(*step)).collect();
        let period = within.iter().sum::<f64>() / within.len().max(1) as f64;
        let holes: f64 = steps.iter().filter(|step| is_hole(**step)).map(|step| step / period - 1.0).sum();
        if holes > (1.0 - PRESENT_SHARE_MIN) * (holes + time.len() as f64) {
            let first = steps.iter().position(|step| is_hole(*step)).unwrap_or_default();
            let share = 100.0 * holes / (holes + time.len() as f64);
            return Err(Failure::new(format!(
                "samples are far from evenly spaced: {share:.0} % of them are lost, first before {} with {} s where {} s are \
                 usual",
                columns.place(first + 1),
                ESTIMATE.write(steps[first]),
                ESTIMATE.write(usual)
            ))
            .with_help("record without losses, or cut the log to a part without losses"));
        }
        let steps: Vec<f64> = std::iter::once(1.0)
            .chain(steps.iter().map(|&step| if is_hole(step) { (step / period).round() } else { 1.0 }))
            .collect();
        Ok(Self::assuming_even(period, steps))
    }

    /// Even samples without holes.
    #[cfg(test)]
    pub fn even(period: f64, samples: usize) -> Self {
        Self::assuming_even(period, vec![1.0; samples])
    }

    /// Assumes evenly taken samples, whatever their stamps.
    fn assuming_even(period: f64, steps: Vec<f64>) -> Self {
        let mut sources = Vec::with_capacity(steps.len());
        for (row, &step) in steps.iter().enumerate() {
            let lost = (1..step as usize).map(|place| ValueSource::Lost(row - 1, place as f64 / step));
            sources.extend(lost);
            sources.push(ValueSource::Sample(row));
        }
        Self::from_sources(period, sources, steps)
    }

    /// Assumes samples taken at their stamps; `time` begins at zero.
    fn assuming_stamps(&self, time: &[f64]) -> Self {
        let period = self.period;
        let last = time.last().copied().unwrap_or_default();
        let mut sources = Vec::new();
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
            sources.push(match from {
                Some(from) if self.steps[row + 1] == 1.0 => {
                    ValueSource::Between(from, weights(&time[from..from + 4], now))
                }
                _ => ValueSource::Lost(row, ((now - time[row]) / (time[row + 1] - time[row])).clamp(0.0, 1.0)),
            });
        }
        Self::from_sources(period, sources, self.steps.clone())
    }

    /// Counts the lost places; short stretches between holes count as lost.
    fn from_sources(period: f64, mut sources: Vec<ValueSource>, steps: Vec<f64>) -> Self {
        let mut from = 0;
        while from < sources.len() {
            let is_lost = |place: &ValueSource| matches!(place, ValueSource::Lost(..));
            let end = (from..sources.len()).find(|place| is_lost(&sources[*place])).unwrap_or(sources.len());
            if end - from < STRETCH_SAMPLES_MIN {
                for place in &mut sources[from..end] {
                    if let ValueSource::Sample(row) | ValueSource::Between(row, _) = *place {
                        *place = ValueSource::Lost(row.min(steps.len().saturating_sub(2)), 0.0);
                    }
                }
            }
            from = (end..sources.len()).find(|place| !is_lost(&sources[*place])).unwrap_or(sources.len());
        }
        let count = |sum: &mut usize, place: &ValueSource| {
            let before = *sum;
            *sum += usize::from(matches!(place, ValueSource::Lost(..)));
            Some(before)
        };
        let mut lost: Vec<usize> = sources.iter().scan(0, count).collect();
        lost.push(sources.iter().filter(|place| matches!(place, ValueSource::Lost(..))).count());
        Self { period, sources, steps, lost, note: None }
    }

    /// Chooses evenly taken samples or the stamps, by the smoother motion; `time` begins at zero.
    pub fn smoother(self, time: &[f64], motion: &[f64]) -> Self {
        let within = |pair: &[f64]| (pair[1] - pair[0]) / self.period;
        let usual: Vec<f64> = time.windows(2).map(within).filter(|step| *step <= HOLE_STEPS).collect();
        let square = usual.iter().map(|step| (step - 1.0).powi(2)).sum::<f64>() / usual.len().max(1) as f64;
        let jitter = square.sqrt();
        if jitter < EVEN_JITTER {
            return Self { note: self.note(0.0, None), ..self };
        }
        let stamped = self.assuming_stamps(time);
        let scatter =
            |times: &Self| Noise::measure(&times.resample(motion), |from, to| times.is_whole(from, to)).mean();
        if scatter(&stamped) < INTERPOLATION_VARIANCE * scatter(&self) {
            Self { note: stamped.note(jitter, Some("interpolated to even times by their stamps")), ..stamped }
        } else {
            Self {
                note: self.note(jitter, Some("treated as even, as the motor's motion is no smoother by the stamps")),
                ..self
            }
        }
    }

    /// Note on lost samples and stamps, for the report.
    fn note(&self, jitter: f64, done: Option<&str>) -> Option<String> {
        let lost = self.lost.last().copied().unwrap_or_default();
        let holes = self.steps.iter().filter(|step| **step > 1.0).count();
        let of_holes = format!(
            "{lost} of {} samples are lost in {holes} holes; moments near them are not used.",
            self.sources.len()
        );
        let of_stamps = |done: &str| format!("Times between samples vary by {:.1} % (rms): {done}.", 100.0 * jitter);
        let parts: Vec<String> = (lost > 0).then_some(of_holes).into_iter().chain(done.map(of_stamps)).collect();
        (!parts.is_empty()).then(|| parts.join(" "))
    }

    /// Even times [s].
    pub fn times(&self) -> Vec<f64> {
        (0..self.sources.len()).map(|place| place as f64 * self.period).collect()
    }

    /// Values at the even times, from values of the samples.
    pub fn resample(&self, values: &[f64]) -> Vec<f64> {
        let resample = |place: &ValueSource| match *place {
            ValueSource::Sample(row) => values[row],
            // Differences to one sample keep their digits after many turns.
            ValueSource::Between(from, weights) => {
                let apart = weights.iter().zip(&values[from..]).map(|(weight, value)| weight * (value - values[from]));
                values[from] + apart.sum::<f64>()
            }
            ValueSource::Lost(row, share) => values[row] + share * (values[row + 1] - values[row]),
        };
        self.sources.iter().map(resample).collect()
    }

    /// Returns true if nothing is lost from one place up to another, excluding the latter.
    pub fn is_whole(&self, from: usize, to: usize) -> bool {
        let at = |place: usize| self.lost[place.min(self.sources.len())];
        at(from) == at(to)
    }

    /// Usual time steps before a sample: 1, or more behind a hole.
    pub fn periods_before(&self, row: usize) -> f64 {
        self.steps.get(row).copied().unwrap_or(1.0)
    }

    /// Divides the steps over holes by the number of usual time steps.
    pub fn per_period_steps(&self, mut steps: Vec<f64>) -> Vec<f64> {
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
        EvenTimes::assuming_even(PERIOD, steps).smoother(time, motion)
    }

    /// Samples with true stamps are interpolated to even times.
    #[test]
    fn true_stamps_are_interpolated() {
        let time = jittering(2000);
        let motion: Vec<f64> = time.iter().map(|time| self::motion(*time)).collect();
        let times = even(&time, &motion);
        assert!(times.note.as_deref().is_some_and(|note| note.contains("interpolated")), "{:?}", times.note);
        for (time, value) in times.times().iter().zip(times.resample(&motion)).skip(2).take(1990) {
            assert!((value - self::motion(*time)).abs() < 1e-7, "{time}: {value}");
        }
    }

    /// Evenly taken samples stay unchanged under jittered stamps.
    #[test]
    fn jittered_stamps_are_ignored() {
        let motion: Vec<f64> = (0..2000).map(|row| self::motion(row as f64 * PERIOD)).collect();
        let times = even(&jittering(2000), &motion);
        assert!(times.note.as_deref().is_some_and(|note| note.contains("treated as even")), "{:?}", times.note);
        assert_eq!(times.resample(&motion), motion);
    }

    /// A hole keeps its length and is marked as lost.
    #[test]
    fn hole_keeps_its_length() {
        let mut steps = vec![1.0; 100];
        steps[50] = 4.0;
        let times = EvenTimes::assuming_even(PERIOD, steps);
        let brought = times.resample(&(0..100).map(f64::from).collect::<Vec<f64>>());
        assert_eq!(brought.len(), 103);
        assert!(times.is_whole(0, 50) && !times.is_whole(49, 51) && times.is_whole(53, 103));
        assert_eq!((brought[49], brought[51], brought[53]), (49.0, 49.5, 50.0));
    }
}

//! Timing monitor: computation time and lateness of the ticks as minimum, mean, maximum and histogram, and counts of
//! overruns, starved and waiting ticks.

use link::messages::{HISTOGRAM_BINS, Timing};

/// Timer that triggers the ticks.
pub trait TickTimer {
    /// Counts since the expiry that triggered this tick; exceeds a period if the tick is longer.
    fn since_expiry(&self) -> u32;
}

/// Least, mean and greatest of a time in timer counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MinMeanMax {
    min: u32,
    max: u32,
    sum: u64,
    count: u32,
}

impl MinMeanMax {
    /// State without times.
    pub const EMPTY: Self = Self { min: u32::MAX, max: 0, sum: 0, count: 0 };

    /// Records a time.
    pub fn record(&mut self, time: u32) {
        self.min = self.min.min(time);
        self.max = self.max.max(time);
        self.sum += u64::from(time);
        self.count = self.count.saturating_add(1);
    }

    /// Minimum, mean and maximum of the recorded times; zeros without times.
    pub fn timing(&self) -> Timing {
        match self.count {
            0 => Timing { min: 0, mean: 0, max: 0 },
            count => Timing { min: self.min, mean: (self.sum / u64::from(count)) as u32, max: self.max },
        }
    }
}

/// Counts and times of the tick.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Monitor {
    /// Steps done.
    pub steps: u32,
    /// Time from the first to the last instruction of ticks that stepped.
    pub computation: MinMeanMax,
    /// Time from the timer's expiry to the first instruction, of all ticks.
    pub lateness: MinMeanMax,
    /// Histogram of computation times with bins of [`Monitor::bin_width`].
    pub histogram: [u32; HISTOGRAM_BINS],
    /// Width of a bin [timer counts].
    pub bin_width: u32,
    /// Ticks that ended after the next tick was due. A tick of several periods counts once: the timer pends only once.
    pub overruns: u32,
    /// Ticks that found no schedule (realtime).
    pub starved: u32,
    /// Ticks that waited for the schedule or for room for a sample (lockstep).
    pub waited: u32,
    /// Least number of commands in the queue while running.
    pub queue_low: u16,
    /// Samples dropped because the queue was full (realtime).
    pub lost_samples: u32,
}

impl Monitor {
    /// Empty monitor; the histogram covers one period.
    pub const fn new(period: u32) -> Self {
        Self {
            steps: 0,
            computation: MinMeanMax::EMPTY,
            lateness: MinMeanMax::EMPTY,
            histogram: [0; HISTOGRAM_BINS],
            bin_width: period.div_ceil(HISTOGRAM_BINS as u32),
            overruns: 0,
            starved: 0,
            waited: 0,
            queue_low: u16::MAX,
            lost_samples: 0,
        }
    }

    /// Records a tick that stepped.
    pub fn record_step(&mut self, computation: u32) {
        self.steps = self.steps.wrapping_add(1);
        self.computation.record(computation);
        let bin = (computation / self.bin_width.max(1)) as usize;
        if let Some(count) = self.histogram.get_mut(bin.min(HISTOGRAM_BINS - 1)) {
            *count = count.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_without_times() {
        assert_eq!(MinMeanMax::EMPTY.timing(), Timing { min: 0, mean: 0, max: 0 });
    }

    #[test]
    fn minimum_mean_maximum_correct() {
        let mut spread = MinMeanMax::EMPTY;
        [7, 3, 5].iter().for_each(|&time| spread.record(time));
        assert_eq!(spread.timing(), Timing { min: 3, mean: 5, max: 7 });
    }

    #[test]
    fn mean_without_overflow() {
        let spread =
            MinMeanMax { min: 1, max: u32::MAX, sum: u64::from(u32::MAX) * u64::from(u32::MAX), count: u32::MAX };
        assert_eq!(spread.timing().mean, u32::MAX);
    }

    /// The last bin is open.
    #[test]
    fn histogram_counts_each_step_once() {
        let period = 8400;
        let mut monitor = Monitor::new(period);
        (0..3 * period).step_by(100).for_each(|time| monitor.record_step(time));
        assert_eq!(monitor.histogram.iter().sum::<u32>(), monitor.steps);
        assert!(monitor.bin_width * HISTOGRAM_BINS as u32 >= period);
        assert!(monitor.histogram[HISTOGRAM_BINS - 1] >= 2 * period / 100);
    }
}

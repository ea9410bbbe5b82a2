//! Pace of the simulated time against the clock, and how late its periods began.

use std::time::{Duration, Instant};

use live::Pace;

/// Lateness after which a run gives up catching up. Time lost beyond it stays lost, so that a client never meets a
/// burst of periods.
const MAX_LATENESS: Duration = Duration::from_millis(50);
/// Width of a class of the histogram.
const CLASS: Duration = Duration::from_micros(10);
/// Number of classes: up to `MAX_LATENESS`.
const CLASSES: usize = 5000;

/// Clock of a run.
#[derive(Debug)]
pub struct Clock {
    pace: Pace,
    histogram: Vec<u64>,
    worst: Duration,
    lost: Duration,
}

/// Lateness of the periods of a run [s].
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Lateness {
    /// Median.
    pub median_s: f64,
    /// Exceeded by one period in a hundred.
    pub p99_s: f64,
    /// Largest.
    pub worst_s: f64,
    /// Time that could not be caught up.
    pub lost_s: f64,
}

impl Clock {
    /// Clock that starts now, with simulated time over that of the clock.
    pub fn new(speed: f64) -> Self {
        Self {
            pace: Pace::starting(Instant::now(), speed),
            histogram: vec![0; CLASSES + 1],
            worst: Duration::ZERO,
            lost: Duration::ZERO,
        }
    }

    /// Time until a simulated time [s] is due; zero once it is.
    pub fn wait(&self, time: f64) -> Duration {
        self.pace.wait(time)
    }

    /// Notes that the period of a simulated time [s] begins.
    pub fn begin(&mut self, time: f64) {
        let late = self.pace.lateness(time);
        let class = (late.as_nanos() / CLASS.as_nanos()) as usize;
        self.histogram[class.min(CLASSES)] += 1;
        self.worst = self.worst.max(late);
        if let Some(lost) = late.checked_sub(MAX_LATENESS) {
            self.pace.postpone(lost);
            self.lost += lost;
        }
    }

    /// Lateness so far.
    pub fn lateness(&self) -> Lateness {
        let count: u64 = self.histogram.iter().sum();
        let quantile = |share: f64| {
            let wanted = (share * count as f64).ceil().max(1.0) as u64;
            let mut below = 0;
            let class = self.histogram.iter().position(|class| {
                below += class;
                below >= wanted
            });
            CLASS.as_secs_f64() * class.unwrap_or(0) as f64
        };
        Lateness {
            median_s: quantile(0.5),
            p99_s: quantile(0.99),
            worst_s: self.worst.as_secs_f64(),
            lost_s: self.lost.as_secs_f64(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_histogram() {
        let mut clock = Clock::new(1.0);
        clock.histogram[0] = 98;
        clock.histogram[7] = 2;
        let lateness = clock.lateness();
        assert_eq!(lateness.median_s, 0.0);
        assert!((lateness.p99_s - 7e-5).abs() < 1e-9, "{}", lateness.p99_s);
    }

    #[test]
    fn time_beyond_the_limit_is_lost() {
        let mut clock = Clock::new(1.0);
        clock.pace = Pace::starting(Instant::now() - Duration::from_secs(3), 1.0);
        clock.begin(1.0);
        let lost = clock.lateness().lost_s;
        assert!((1.9..2.0).contains(&lost), "{lost}");
        assert!(clock.wait(1.0).is_zero());
        assert!(clock.wait(2.0) > Duration::from_millis(900));
    }
}

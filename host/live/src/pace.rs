//! Pace of a run against the clock.

use std::time::{Duration, Instant};

/// Pace of a run that follows the clock at a multiple of real time.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    start: Instant,
    speed: f64,
}

impl Pace {
    /// Pace of a run that starts at a moment; `speed` is the run's time over the clock's.
    pub fn starting(start: Instant, speed: f64) -> Self {
        Self { start, speed }
    }

    /// Time until a time of the run [s] is due; zero once it is.
    pub fn wait(&self, time: f64) -> Duration {
        self.due(time).saturating_duration_since(Instant::now())
    }

    /// Time since a time of the run [s] was due; zero until it is.
    pub fn lateness(&self, time: f64) -> Duration {
        Instant::now().saturating_duration_since(self.due(time))
    }

    /// Postpones all times of the run that are still due.
    pub fn postpone(&mut self, delay: Duration) {
        self.start += delay;
    }

    fn due(&self, time: f64) -> Instant {
        self.start + Duration::from_secs_f64((time / self.speed).max(0.0))
    }
}

/// Reads a speed of a run from a command line.
pub fn parse_speed(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (0.001..=1000.0).contains(value));
    value.ok_or_else(|| "write a number from 0.001 to 1000".to_owned())
}

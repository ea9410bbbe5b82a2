//! Timing statistics, memory use and losses of a board. The host checks them against its limits.

use serde::{Deserialize, Serialize};

/// Bins of the computation-time histogram.
pub const HISTOGRAM_BINS: usize = 32;

/// Timing statistics since the last clearing. Times are timer counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Completed steps.
    pub ticks: u32,
    /// Computation time of the tick.
    pub computation: Timing,
    /// Time from the timer's expiry to the first instruction of the tick.
    pub lateness: Timing,
    /// Histogram of computation times: bin i counts steps in [i, i + 1) * `bin_width`; the last bin is open.
    pub histogram: [u32; HISTOGRAM_BINS],
    /// Width of a bin.
    pub bin_width: u32,
    /// Timer counts between two ticks.
    pub period: u32,
    /// Idle time, in thousandths of all time.
    pub idle_permille: u16,
    /// Ticks that ended after the next tick was due.
    pub overruns: u32,
    /// Ticks that found no schedule (realtime).
    pub starved: u32,
    /// Ticks that waited for the schedule (lockstep).
    pub waited: u32,
    /// Least number of commands in the queue while running.
    pub queue_low: u16,
    /// Schedules missing by sequence number.
    pub lost_schedules: u32,
    /// Frames dropped for a bad CRC, length or content.
    pub bad_frames: u32,
    /// Received bytes dropped because a buffer was full.
    pub lost_bytes: u32,
    /// Samples dropped because a buffer was full.
    pub lost_samples: u32,
    /// Log bytes dropped because a buffer was full.
    pub lost_log_bytes: u32,
    /// RAM in use by statics [byte].
    pub static_ram: u32,
    /// Deepest stack seen, by painting [byte].
    pub stack_used: u32,
}

/// Minimum, mean and maximum of a time [timer counts].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// Minimum.
    pub min: u32,
    /// Mean.
    pub mean: u32,
    /// Maximum.
    pub max: u32,
}

//! Wire form of the timing statistics: counts of the tick, of idle and of the serial line.

use link::messages::Statistics;

use crate::timing_monitor::Monitor;

/// Counts of idle and of the serial line; cleared together with the tick's monitor.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LineCounts {
    /// Schedules missing by sequence number.
    pub lost_schedules: u32,
    /// Frames dropped for a bad CRC, length or content.
    pub bad_frames: u32,
    /// Received bytes dropped.
    pub lost_bytes: u32,
    /// Log bytes dropped.
    pub lost_log_bytes: u32,
}

impl LineCounts {
    /// Counts added since an earlier reading.
    #[must_use]
    pub fn since(self, earlier: Self) -> Self {
        Self {
            lost_schedules: self.lost_schedules.wrapping_sub(earlier.lost_schedules),
            bad_frames: self.bad_frames.wrapping_sub(earlier.bad_frames),
            lost_bytes: self.lost_bytes.wrapping_sub(earlier.lost_bytes),
            lost_log_bytes: self.lost_log_bytes.wrapping_sub(earlier.lost_log_bytes),
        }
    }
}

/// Idle time and memory use; read when a report is due.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Resources {
    /// Idle time, in thousandths of all time.
    pub idle_permille: u16,
    /// RAM in use by statics [byte].
    pub static_ram: u32,
    /// Deepest stack seen [byte].
    pub stack_used: u32,
}

/// Joins the counts of tick, line and resources.
pub fn statistics(monitor: &Monitor, period: u32, line: LineCounts, resources: Resources) -> Statistics {
    Statistics {
        ticks: monitor.steps,
        computation: monitor.computation.timing(),
        lateness: monitor.lateness.timing(),
        histogram: monitor.histogram,
        bin_width: monitor.bin_width,
        period,
        idle_permille: resources.idle_permille,
        overruns: monitor.overruns,
        starved: monitor.starved,
        waited: monitor.waited,
        queue_low: if monitor.steps == 0 { 0 } else { monitor.queue_low },
        lost_schedules: line.lost_schedules,
        bad_frames: line.bad_frames,
        lost_bytes: line.lost_bytes,
        lost_samples: monitor.lost_samples,
        lost_log_bytes: line.lost_log_bytes,
        static_ram: resources.static_ram,
        stack_used: resources.stack_used,
    }
}

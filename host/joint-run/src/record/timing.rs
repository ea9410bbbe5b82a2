//! Timing of the board in SI, from the raw counts of the line.

use serde::{Deserialize, Serialize};

use link::messages::{Statistics, Timing};

/// Timing monitor of the board.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TimingFigures {
    /// Timer rate, the divisor of the raw counts [Hz].
    #[serde(rename = "timer_rate_Hz")]
    pub timer_rate_hz: u32,
    /// Steps that the figures cover.
    pub ticks: u32,
    /// Time between two ticks: the deadline [s].
    pub period_s: f64,
    /// Computation time of the tick.
    pub computation: MinMeanMax,
    /// Time from the timer's expiry to the first instruction of the tick.
    pub lateness: MinMeanMax,
    /// Computation times; the last bin holds everything above its lower end.
    pub histogram: Vec<HistogramBin>,
    /// Share of idle time [%].
    pub idle_percent: f64,
    /// Counters of faults and other events.
    pub counters: Counters,
    /// RAM used by statics, as reported by the board [byte].
    pub static_ram_bytes: u32,
    /// Deepest stack [byte].
    pub stack_used_bytes: u32,
}

/// Least, mean and greatest [s].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MinMeanMax {
    /// Least [s].
    pub min_s: f64,
    /// Mean [s].
    pub mean_s: f64,
    /// Greatest [s].
    pub max_s: f64,
}

/// One bin of the histogram.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HistogramBin {
    /// Lower end [s].
    pub from_s: f64,
    /// Steps in the bin.
    pub steps: u32,
}

/// Counts since the last clearing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Counters {
    /// Ticks that ended after the next was due.
    pub overruns: u32,
    /// Ticks that found no schedule (realtime).
    pub starved: u32,
    /// Ticks that waited for the schedule (lockstep).
    pub waited: u32,
    /// Least number of commands in the queue while running.
    pub queue_low: u32,
    /// Schedules that never reached the board.
    pub lost_schedules: u32,
    /// Frames that the board dropped for a bad CRC, length or content.
    pub bad_frames_board: u32,
    /// Frames that the host dropped for a bad CRC, length or content.
    pub bad_frames_host: u32,
    /// Sample batches that never reached the host, by sequence number.
    pub lost_batches_host: u32,
    /// Log frames that never reached the host, by sequence number.
    pub lost_logs_host: u32,
    /// Received bytes that the board dropped because a buffer was full.
    pub lost_bytes: u32,
    /// Samples that the board dropped because a buffer was full.
    pub lost_samples: u32,
    /// Log bytes that the board dropped because a buffer was full.
    pub lost_log_bytes: u32,
}

impl TimingFigures {
    /// Statistics of the board in SI. Counters of the host are zero, to be filled in by the caller.
    pub fn from_board(raw: &Statistics, timer_rate: u32) -> Self {
        let seconds = |counts: u32| f64::from(counts) / f64::from(timer_rate);
        let timing =
            |raw: Timing| MinMeanMax { min_s: seconds(raw.min), mean_s: seconds(raw.mean), max_s: seconds(raw.max) };
        let bin =
            |(index, &steps): (usize, &u32)| HistogramBin { from_s: index as f64 * seconds(raw.bin_width), steps };
        Self {
            timer_rate_hz: timer_rate,
            ticks: raw.ticks,
            period_s: seconds(raw.period),
            computation: timing(raw.computation),
            lateness: timing(raw.lateness),
            histogram: raw.histogram.iter().enumerate().map(bin).collect(),
            idle_percent: f64::from(raw.idle_permille) / 10.0,
            counters: Counters {
                overruns: raw.overruns,
                starved: raw.starved,
                waited: raw.waited,
                queue_low: u32::from(raw.queue_low),
                lost_schedules: raw.lost_schedules,
                bad_frames_board: raw.bad_frames,
                bad_frames_host: 0,
                lost_batches_host: 0,
                lost_logs_host: 0,
                lost_bytes: raw.lost_bytes,
                lost_samples: raw.lost_samples,
                lost_log_bytes: raw.lost_log_bytes,
            },
            static_ram_bytes: raw.static_ram,
            stack_used_bytes: raw.stack_used,
        }
    }
}

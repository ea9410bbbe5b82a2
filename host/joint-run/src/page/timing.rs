//! Timing of the board: the histogram with its deadline, and the counters. The table of checks has the checks of both.

use crate::record::TimingFigures;
use report::number::PAGE;
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::{Panel, VerticalAxis};
use report::plot::unit::{MICROSECONDS, Unit};

/// Histogram of the computation times, with the deadline.
pub fn histogram(timing: &TimingFigures) -> Option<Figure> {
    let width = timing.histogram.get(1).map(|bin| bin.from_s)?;
    let filled = || timing.histogram.iter().filter(|bin| bin.steps > 0);
    let last = filled().next_back()?;
    let end = (last.from_s + width).max(timing.computation.max_s).max(timing.period_s) * 1.04;
    if !(end.is_finite() && end > 0.0 && width > 0.0) {
        return None;
    }
    let bar = |from: f64, steps: u32| [from + 0.06 * width, from + 0.94 * width, 0.0, f64::from(steps)];
    let boxes = filled().map(|bin| bar(bin.from_s, bin.steps)).collect();
    let label = format!("deadline: next tick after {} µs", PAGE.write(1e6 * timing.period_s));
    let marks = vec![
        Mark::Boxes { boxes, ink: Ink::Bar, label: "steps".into() },
        Mark::Deadline { at: timing.period_s, label },
    ];
    let unit = Unit { factor: 1.0, name: "steps" };
    let panel = Panel { axis: VerticalAxis::Counts, ..Panel::lines("Computation time of the tick", unit, marks) };
    let title = "Computation times of the tick against the deadline";
    Some(Figure::new(title, "computation time", MICROSECONDS, (0.0, end), vec![panel]))
}

/// Rows of the table of counts: name, count, true if only zero is good, meaning.
pub fn counts(timing: &TimingFigures) -> Vec<(&'static str, u32, bool, &'static str)> {
    let counters = &timing.counters;
    vec![
        ("Overruns", counters.overruns, true, "ticks that ended after the next was due"),
        ("Starved ticks", counters.starved, true, "found no schedule and held the last torque (realtime)"),
        ("Waits", counters.waited, false, "ticks that waited for the schedule (lockstep)"),
        ("Lowest queue", counters.queue_low, false, "fewest commands waiting while running"),
        ("Lost schedules", counters.lost_schedules, true, "missing by sequence number, at the board"),
        ("Lost batches", counters.lost_batches_host, true, "of samples, missing by sequence number, at the host"),
        ("Lost log frames", counters.lost_logs_host, true, "missing by sequence number, at the host"),
        ("Bad frames, board", counters.bad_frames_board, true, "dropped for checksum, length or content"),
        ("Bad frames, host", counters.bad_frames_host, true, "dropped for checksum, length or content"),
        ("Lost bytes", counters.lost_bytes, true, "received by the board into a full buffer"),
        ("Lost samples", counters.lost_samples, true, "dropped by the board, buffer full"),
        ("Lost log bytes", counters.lost_log_bytes, true, "dropped by the board, buffer full"),
    ]
}

//! Checks of a run: each figure with its bound and the bound's source. An interrupted run is judged by the available
//! figures; the other checks are marked as not run.

use crate::origin::clock_text;
use link::messages::{ClockSource, RunMode, Statistics};

use super::comparison::Comparison;
use board::device::image::Image;
use board::logs::Log;
use board::recording::Recording;
use board::twin::Agreement;
use report::checks::{Bound, Check, Source};

/// Least steps covered by the twin, unless a shorter run was requested.
const TWIN_STEPS_MIN: u32 = 100_000;
/// Flash budget of the plant's image: a quarter of the smallest board's [byte].
const FLASH_BUDGET: f64 = 128.0 * 1024.0;
/// RAM budget of statics and deepest stack together [byte].
const RAM_BUDGET: f64 = 16.0 * 1024.0;
/// Least predictable part of a run for which the bounds apply.
const PREDICTABLE_SHARE_MIN: f64 = 0.1;

/// Inputs of the checks; missing inputs carry their reason.
pub struct Evidence<'a> {
    /// Recording of the session.
    pub recording: &'a Recording,
    /// Ticks of the planned run.
    pub ticks: u32,
    /// Comparison with the twin.
    pub agreement: &'a Agreement,
    /// Comparison with the reference.
    pub comparison: Result<&'a Comparison, &'a str>,
    /// Decoded log.
    pub log: Result<&'a Log, &'a str>,
    /// Image of the run.
    pub image: Result<&'a Image, &'a str>,
}

/// All checks, the most important first.
pub fn checks(evidence: &Evidence<'_>) -> Vec<Check> {
    let mut checks = twin(evidence);
    checks.extend(reference(evidence));
    checks.extend(line(evidence));
    checks.extend(timing(evidence));
    checks.extend(memory(evidence));
    checks.extend(log(evidence));
    checks
}

fn count(name: &str, figure: impl Into<f64>, bound: Bound, source: Source) -> Check {
    Check::new(name, figure.into(), "", bound, source)
}

fn zero(name: &str, figure: u32, source: Source) -> Check {
    count(name, figure, Bound::Exactly(0.0), source)
}

fn twin(evidence: &Evidence<'_>) -> Vec<Check> {
    let agreement = evidence.agreement;
    let decimation = evidence.recording.settings.map_or(1, |settings| u32::from(settings.decimation));
    let wanted = TWIN_STEPS_MIN.min(evidence.ticks - evidence.ticks % decimation);
    let note = match &agreement.first {
        None => "digest of the whole state at every step, samples in every bit".to_owned(),
        Some(first) => {
            format!("first difference at tick {}: {} is {}, not {}", first.tick, first.field, first.board, first.twin)
        }
    };
    vec![
        count(
            "samples that differ from the host's f32 twin",
            agreement.different as u32,
            Bound::Exactly(0.0),
            Source::Host,
        )
        .note(note),
        count("steps equal to the twin's, bit for bit", agreement.steps, Bound::AtLeast(wanted.into()), Source::Host),
    ]
}

fn reference(evidence: &Evidence<'_>) -> Vec<Check> {
    let comparison = match evidence.comparison {
        Ok(comparison) => comparison,
        Err(why) => return vec![Check::not_run("motion off the f64 reference", "%", Bound::None, why)],
    };
    let chaotic = comparison.until < PREDICTABLE_SHARE_MIN * comparison.of;
    let part =
        format!("of the motion's standard deviation, over the first {:.2} of {:.2} s", comparison.until, comparison.of);
    let note = match (chaotic, comparison.until < comparison.of) {
        (true, _) => format!("{part}: the motion is chaotic, so no bound is applied"),
        (false, true) => format!("{part}: later the motion is chaotic, or beyond the compared time"),
        (false, false) => part,
    };
    let check = |quantity: &super::comparison::QuantityError| {
        let bound = if chaotic { Bound::None } else { Bound::AtMost(100.0 * quantity.limit) };
        let name = format!("{} off the f64 reference, first {:.2} s", quantity.name, comparison.until);
        Check::new(name, 100.0 * quantity.error, "%", bound, Source::Host).note(note.clone())
    };
    comparison.errors.iter().map(check).collect()
}

fn line(evidence: &Evidence<'_>) -> Vec<Check> {
    let recording = evidence.recording;
    let traffic = &recording.traffic;
    let decimation = recording.settings.map_or(1, |settings| u32::from(settings.decimation));
    let samples = f64::from(evidence.ticks / decimation);
    let mut checks = vec![
        count("samples received", recording.samples.len() as u32, Bound::Exactly(samples), Source::Host),
        zero("sample batches lost on the line", traffic.lost_batches, Source::Host),
        zero("log frames lost on the line", traffic.lost_logs, Source::Host),
        zero("bad frames at the host", traffic.bad_frames, Source::Host),
        count("faults of the board", recording.trips.len() as u32, Bound::Exactly(0.0), Source::Board),
    ];
    if let Some(statistics) = &recording.statistics {
        checks.extend([
            zero("schedules lost on the line", statistics.lost_schedules, Source::Board),
            zero("bad frames at the board", statistics.bad_frames, Source::Board),
            zero("bytes dropped by the board", statistics.lost_bytes, Source::Board),
            zero("samples dropped by the board", statistics.lost_samples, Source::Board),
            zero("log bytes dropped by the board", statistics.lost_log_bytes, Source::Board),
        ]);
    }
    checks
}

fn timing(evidence: &Evidence<'_>) -> Vec<Check> {
    let recording = evidence.recording;
    let (Some(statistics), Some(hello)) = (&recording.statistics, &recording.hello) else {
        let why = "the board no longer answers";
        return vec![Check::not_run("overruns", "", Bound::Exactly(0.0), why)];
    };
    let microseconds = |counts: u32| 1e6 * f64::from(counts) / f64::from(hello.timer_rate);
    let time =
        |name: &str, counts: u32, bound: Bound| Check::new(name, microseconds(counts), "us", bound, Source::Board);
    let period = Bound::AtMost(microseconds(statistics.period));
    let mut checks = vec![
        zero("overruns", statistics.overruns, Source::Board),
        time("computation time of a tick, greatest", statistics.computation.max, period),
        time("computation time of a tick, mean", statistics.computation.mean, Bound::None),
        time("lateness of a tick, greatest", statistics.lateness.max, period),
        Check::new("idle time", f64::from(statistics.idle_permille) / 10.0, "%", Bound::None, Source::Board),
    ];
    checks.extend(queue(recording.settings.map(|settings| settings.mode), statistics));
    let clock_runs = u32::from(hello.clock.source != ClockSource::Failed);
    let clock = count("core clock as stated", clock_runs, Bound::Exactly(1.0), Source::Board);
    checks.push(clock.note(clock_text(hello.clock)));
    checks
}

fn queue(mode: Option<RunMode>, statistics: &Statistics) -> Vec<Check> {
    match mode {
        Some(RunMode::Realtime) => vec![
            zero("ticks without a schedule", statistics.starved, Source::Board),
            count("commands in the queue, least", statistics.queue_low, Bound::None, Source::Board),
        ],
        _ => vec![
            count("ticks that waited for the schedule or the line", statistics.waited, Bound::None, Source::Board)
                .note("lockstep: waiting costs no step"),
        ],
    }
}

fn memory(evidence: &Evidence<'_>) -> Vec<Check> {
    let flash = Bound::AtMost(FLASH_BUDGET);
    let mut checks = vec![match evidence.image {
        Ok(image) => Check::new("flash used by the image", image.flash_bytes as f64, "B", flash, Source::Image),
        Err(why) => Check::not_run("flash used by the image", "B", flash, why),
    }];
    if let Some(statistics) = &evidence.recording.statistics {
        let used = f64::from(statistics.static_ram) + f64::from(statistics.stack_used);
        let note =
            format!("{} B of statics and {} B of stack at its deepest", statistics.static_ram, statistics.stack_used);
        checks.push(Check::new("RAM used", used, "B", Bound::AtMost(RAM_BUDGET), Source::Board).note(note));
    }
    checks
}

fn log(evidence: &Evidence<'_>) -> Vec<Check> {
    let lines = Bound::AtLeast(1.0);
    match evidence.log {
        Ok(log) => vec![
            count("log lines decoded", log.lines.len() as u32, lines, Source::Board)
                .note(log.lines.first().map(|line| line.text.clone()).unwrap_or_default()),
            zero("log entries that could not be decoded", log.malformed, Source::Host),
        ],
        Err(why) => vec![Check::not_run("log lines decoded", "", lines, why)],
    }
}

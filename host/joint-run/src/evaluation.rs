//! Evaluation of a session into the record of a run: SI units, the host's computations of the run, and the verdicts.
//! This module neither talks to a board nor writes files.

use link::messages::Sample;

use super::checks::{self, Evidence};
use super::comparison::{self, Comparison, PendingReferences};
use super::origin;
use super::plan::RunPlan;
use crate::page;
use crate::record::{CloseUp, Completeness, MotionSample, RunRecord, Samples, TimingFigures, TorqueCommand};
use board::device::image::Image;
use board::logs;
use board::logs::Log;
use board::recording::Recording;
use board::{trip, twin};
use report::failure::Outcome;

/// Longest close-up [ticks].
const CLOSE_UP_TICKS: u32 = 4000;

/// Run that has ended, complete or not.
pub struct FinishedRun<'a> {
    /// Plan of the run.
    pub plan: &'a RunPlan,
    /// Recording of the board.
    pub recording: &'a Recording,
    /// Image, if it was built here.
    pub image: Option<&'a Image>,
    /// Result of the session.
    pub outcome: &'a Outcome<()>,
}

/// Starts the references of a planned run.
pub fn start_references(plan: &RunPlan) -> PendingReferences {
    let run = (plan.profile.commands.as_slice(), plan.profile.ticks);
    comparison::start(&plan.joint.parameters, plan.expected.tick_rate, plan.settings.decimation.into(), run)
}

/// Fills the record.
pub fn evaluate(
    record: &mut RunRecord,
    finished: &FinishedRun<'_>,
    references: Option<PendingReferences>,
) -> Outcome<()> {
    let FinishedRun { plan, recording, image, outcome } = *finished;
    let joint = &plan.joint.parameters;
    let tick_rate = plan.expected.tick_rate;
    let timer_rate = recording.hello.as_ref().map_or(1, |hello| hello.timer_rate.max(1));
    if let Some(hello) = &recording.hello {
        origin::note_board(&mut record.identity, hello);
    }
    record.completeness = match outcome {
        Ok(()) => Completeness::Complete,
        Err(failure) => Completeness::Interrupted { reason: failure.message().to_owned(), tick: recording.last_tick() },
    };
    record.schedule = recording
        .accepted
        .iter()
        .map(|command| TorqueCommand {
            tick: command.tick,
            drive_torque: command.drive_torque,
            load_torque: command.load_torque,
        })
        .collect();
    for sample in &recording.samples {
        record.samples.push(&MotionSample::from_board(sample, timer_rate), tick_rate, record.joint.ratio);
    }
    record.timing = recording.statistics.as_ref().map(|statistics| timing(statistics, recording, timer_rate));
    record.faults = recording.trips.iter().map(trip::entry).collect();
    let log = decode(recording, image);
    if let Ok(log) = &log {
        record.log.clone_from(&log.lines);
    }

    let agreement =
        twin::compare(joint, finished.plan.board.chip(), tick_rate, &recording.accepted, &recording.samples)?;
    if agreement.different == 0 && !recording.samples.is_empty() {
        record.close_up = close_up(record, finished)?;
    }
    let comparison = compare(references, finished, record.joint.ratio);
    if let Ok(comparison) = &comparison {
        record.reference = Some(comparison.reference.clone());
    }
    record.checks = checks::checks(&Evidence {
        recording,
        ticks: plan.profile.ticks,
        agreement: &agreement,
        comparison: comparison.as_ref().map_err(String::as_str),
        log: log.as_ref().map_err(String::as_str),
        image: image.ok_or("the image was not built here"),
    });
    Ok(())
}

fn timing(statistics: &link::messages::Statistics, recording: &Recording, timer_rate: u32) -> TimingFigures {
    let mut timing = TimingFigures::from_board(statistics, timer_rate);
    timing.counters.bad_frames_host = recording.traffic.bad_frames;
    timing.counters.lost_batches_host = recording.traffic.lost_batches;
    timing.counters.lost_logs_host = recording.traffic.lost_logs;
    timing
}

fn decode(recording: &Recording, image: Option<&Image>) -> Result<Log, String> {
    let image = image.ok_or("the image was not built here")?;
    logs::decode(&recording.log, &image.elf).map_err(|failure| failure.message().to_owned())
}

fn compare(
    references: Option<PendingReferences>,
    finished: &FinishedRun<'_>,
    ratio: f64,
) -> Result<Comparison, String> {
    let references = references.ok_or("skipped by --no-reference")?;
    if finished.outcome.is_err() {
        references.abandon();
        return Err("the run broke off".to_owned());
    }
    references.finish(&finished.recording.samples, ratio).map_err(|failure| failure.message().to_owned())
}

/// First crossing of the gap at every tick, by the twin.
fn close_up(record: &RunRecord, finished: &FinishedRun<'_>) -> Outcome<Option<CloseUp>> {
    let Some((from, to)) = page::crossing(&record.samples, record.joint.gap_band_m) else { return Ok(None) };
    let tick_rate = finished.plan.expected.tick_rate;
    let tick = |time: f64| (time * f64::from(tick_rate)).max(0.0) as u32;
    let last = finished.recording.last_tick();
    let first = tick(from).min(last);
    let ticks: Vec<u32> = (first..=tick(to).min(last).min(first + CLOSE_UP_TICKS)).collect();
    let parameters = &finished.plan.joint.parameters;
    let motion: Vec<Sample> =
        twin::replay(parameters, finished.plan.board.chip(), tick_rate, &finished.recording.accepted, &ticks)?;
    let mut samples = Samples::new(2 * record.joint.planets);
    for sample in &motion {
        let motion = MotionSample { computation: None, ..MotionSample::from_board(sample, 1) };
        samples.push(&motion, tick_rate, record.joint.ratio);
    }
    Ok(Some(CloseUp { method: "the host's f32 twin, equal to the board bit for bit".to_owned(), samples }))
}

//! Simulation of any joint by a named scheme, on the host.
//!
//! `plan` validates the request; `stepping` simulates the joint by a `scheme` from a `start` and passes a `snapshot` of
//! every tick to `statistics`, `energy` and the files (`csv`, `log_file`, both with the `quantities`); `result` holds
//! the results; `live_view` shows a run while it goes on; `comparison` runs all schemes; `summary` is the result as data, `page` and its pictures show it.

pub mod arguments;
pub mod comparison;
pub mod csv;
pub mod energy;
pub mod errors;
pub mod files;
pub mod live_view;
pub mod log_file;
mod page;
mod pictures;
pub mod plan;
mod portraits;
mod quantities;
mod result;
pub mod scheme;
mod scheme_pictures;
pub mod snapshot;
pub mod start;
pub mod statistics;
pub mod stepping;
pub mod summary;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use arguments::Arguments;
use comparison::Comparison;
use files::HistoryFiles;
use plan::SimulationPlan;
use result::{PROGRESS_INTERVAL, SimulationResult};
use scheme::{SchemeChoice, SchemeName};
use stepping::RunEnd;
use summary::SimulationSummary;

use joint_file::{named, warnings};
use live::Live;
use report::command_line::{program, quoted};
use report::document::{html, terminal};
use report::failure::{Failure, Outcome};
use report::folder::{self, Folder};
use report::interruption::UninterruptedWork;
use report::output;
use report::progress::Progress;
use report::provenance::VERSION;

/// Largest number of samples by default.
const DEFAULT_SAMPLES: u32 = 200_000;
/// Largest number of samples; each takes half a kilobyte.
const MAX_SAMPLES: u32 = 2_000_000;

/// Texts and paths of a finished simulation.
pub struct Simulated {
    /// Figures for a terminal.
    pub summary: String,
    /// Figures as JSON.
    pub figures: String,
    /// Path of the page.
    pub report: PathBuf,
    /// Paths of the samples as CSV and as MCAP.
    pub history: [PathBuf; 2],
}

/// Simulates a joint and writes report, figures and history to its folder.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<Simulated> {
    arguments.motion.check_for(arguments.scheme.shown())?;
    let loaded = named::load_with(&arguments.file, &arguments.motion.set)?;
    arguments.scheme.shown().check_joint(&loaded.file.parameters)?;
    warnings::print(&loaded);
    let plan = SimulationPlan::new(loaded, &arguments.motion)?;
    let every = sample_interval(&plan, arguments.every)?;
    let scheme = arguments.scheme.shown();
    let profile = arguments.motion.profile.as_deref().unwrap_or_default();
    folder::check_files(&[("json", arguments.json.as_deref())], &[&arguments.file, Path::new(profile)])?;
    let folder = Folder::prepare(arguments.out.as_deref(), "sim", &plan.parameters().name, &files::RUN_FILES)?;
    let live = Live::start_paced(&arguments.live, "joint sim")?;
    live.iter().for_each(|live| live.announce(progress));
    let mut feed = live.as_ref().and_then(|live| live.feed(live_view::description(1, &plan.name, plan.parameters())));
    // An interruption must still finish the history.
    let uninterrupted = UninterruptedWork::begin();
    let mut files = HistoryFiles::begin(&folder, plan.parameters(), remarks(arguments, &plan, scheme))?;
    progress.run("simulating", plan.run.ticks);
    let result =
        SimulationResult::simulate(&plan, scheme, every, !arguments.no_energy, &mut files, feed.as_mut(), progress);
    drop(feed);
    let stopped = matches!(&result, Ok(SimulationResult { end: RunEnd::Stopped, .. }));
    let mut result = match result {
        Ok(result) => result,
        Err(failure) => return Err(files.finish_after(failure)),
    };
    let [csv, log] = files.finish(!stopped)?;
    if stopped {
        let time = f64::from(result.ticks) / f64::from(plan.run.tick_rate);
        return Err(Failure::interrupted(format!("stopped by the user at {time:.4} s of {:.4} s", plan.duration()))
            .with_help(format!("the history so far is in {} and {}", csv.display(), log.display())));
    }
    drop(uninterrupted);
    if arguments.scheme == SchemeChoice::All {
        result.comparison = Some(compare(&plan, every, progress)?);
    }
    progress.stage("drawing");
    let figures = SimulationSummary::new(&result, &arguments.motion.set);
    let document = page::document(&result, &figures, &replay_command(arguments));
    folder.write_text(files::REPORT, &html(&document))?;
    let json = output::json("figures", &figures)?;
    folder.write_text(files::FIGURES, &json)?;
    Ok(Simulated {
        summary: terminal(&document),
        figures: json,
        report: folder.file(files::REPORT),
        history: [csv, log],
    })
}

/// Ticks between two samples.
fn sample_interval(plan: &SimulationPlan, wanted: Option<u32>) -> Outcome<u32> {
    let every = wanted.unwrap_or_else(|| plan.run.ticks.div_ceil(DEFAULT_SAMPLES)).max(1);
    let samples = plan.run.ticks / every + 1;
    if samples > MAX_SAMPLES {
        let least = plan.run.ticks.div_ceil(MAX_SAMPLES);
        return Err(Failure::new(format!("every {every} of {} ticks are {samples} samples", plan.run.ticks))
            .with_help(format!("give --every {least} or more, or a shorter --duration")));
    }
    Ok(every)
}

fn compare(plan: &SimulationPlan, every: u32, progress: &Progress) -> Outcome<Comparison> {
    // Every scheme and the disturbed reference run over all ticks.
    let runs = 1 + SchemeName::for_joint(plan.parameters()).len() as u32;
    progress.run("comparing schemes", plan.run.ticks);
    comparison::compare(&plan.run, every, &|done| {
        if (done / runs).is_multiple_of(PROGRESS_INTERVAL) {
            progress.set_position(done / runs);
        }
    })
}

/// Remarks in the log.
fn remarks(arguments: &Arguments, plan: &SimulationPlan, scheme: SchemeName) -> BTreeMap<String, String> {
    [
        ("joint", plan.parameters().name.to_string()),
        ("joint_file", plan.name.clone()),
        ("scheme", scheme.name().to_owned()),
        ("tick_rate_hz", plan.run.tick_rate.to_string()),
        ("torques", plan.torques_name.clone()),
        ("command", replay_command(arguments)),
        ("version", VERSION.to_owned()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// Command that repeats this run.
fn replay_command(arguments: &Arguments) -> String {
    let mut command = format!("{} sim {}", program(), quoted(&arguments.file.display().to_string()));
    command += &format!(" --scheme {}", arguments.scheme.name());
    command += &arguments.motion.replay();
    if let Some(every) = arguments.every {
        command += &format!(" --every {every}");
    }
    command
}

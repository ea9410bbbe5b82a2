//! Any joint moved by a named scheme, on the host. What a board computes and how it is checked is `hil`'s
//! business, studies over many joints are `sweep`'s.
//!
//! `plan` finds everything that is wrong with the request, `follow` moves the joint by a `scheme` from a `start`, and
//! shows a `moment` every tick to `statistics`, `energy` and the files (`csv`, `log_file`); `comparison` runs all
//! schemes; `figures` is what comes of it, `page` and its pictures show it.

pub mod arguments;
pub mod comparison;
pub mod csv;
pub mod energy;
pub mod figures;
pub mod files;
pub mod follow;
mod judgement;
pub mod log_file;
pub mod moment;
mod page;
mod pictures;
pub mod plan;
mod portraits;
pub mod scheme;
pub mod start;
pub mod statistics;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

pub use arguments::Arguments;
use comparison::Comparison;
use energy::EnergyBook;
use figures::{Figures, Gathered};
use files::HistoryFiles;
use follow::End;
use moment::Moment;
use plan::Plan;
use scheme::{Choice, SchemeName};
use statistics::Statistics;

use joint_file::named;
use report::document::{html, terminal};
use report::failure::{Failure, Outcome};
use report::folder;
use report::folder::Folder;
use report::progress::Progress;
use report::provenance::VERSION;
use report::spectrum::Spectrum;
use report::write::write_text;
use report::{interruption, output};

/// Samples that are kept at most unless `--every` says how many ticks apart they are.
const USUAL_SAMPLES: u32 = 200_000;
/// Samples that can be kept: each takes half a kilobyte.
const MOST_SAMPLES: u32 = 2_000_000;
/// The progress line moves once in so many ticks.
const PROGRESS: u32 = 1024;

/// What a simulation leaves.
pub struct Simulated {
    /// The figures for a terminal.
    pub summary: String,
    /// The same as JSON.
    pub figures: String,
    /// The page.
    pub report: PathBuf,
    /// Samples as CSV and as MCAP.
    pub history: [PathBuf; 2],
}

/// What a run has gathered.
struct Ran<'a> {
    end: End,
    ticks: u32,
    samples: Vec<Moment>,
    statistics: Statistics,
    energy: Option<EnergyBook<'a>>,
}

/// Simulates a joint; report, figures and history are in its folder then.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<Simulated> {
    let loaded = named::load_with(&arguments.file, &arguments.motion.set)?;
    let plan = Plan::new(loaded, &arguments.motion)?;
    let every = every(&plan, arguments.every)?;
    let scheme = arguments.scheme.shown();
    let profile = arguments.motion.profile.as_deref().unwrap_or_default();
    folder::check_files(&[("json", arguments.json.as_deref())], &[&arguments.file, Path::new(profile)])?;
    let folder = Folder::prepare(arguments.out.as_deref(), "sim", &plan.parameters().name)?;
    let mut files = HistoryFiles::begin(&folder, plan.parameters(), remarks(arguments, &plan, scheme))?;
    progress.run("simulating", plan.ticks);
    let ran = simulate(&plan, scheme, every, !arguments.no_energy, &mut files, progress);
    let stopped = matches!(&ran, Ok(Ran { end: End::Stopped, .. }));
    let history = files.finish(ran.is_ok() && !stopped);
    let ran = ran?;
    let [csv, log] = history?;
    if stopped {
        let time = f64::from(ran.ticks) / f64::from(plan.tick_rate);
        return Err(Failure::interrupted(format!("stopped by the user at {time:.4} s of {:.4} s", plan.duration()))
            .with_help(format!("the history so far is in {} and {}", csv.display(), log.display())));
    }
    let comparison = match arguments.scheme {
        Choice::All => Some(compare(&plan, every, progress)?),
        _ => None,
    };
    progress.stage("drawing");
    let spectrum = spectrum(&plan, &ran.samples, every);
    let balance = ran.energy.as_ref().and_then(EnergyBook::balance);
    let figures = Figures::of(&Gathered {
        plan: &plan,
        set: &arguments.motion.set,
        scheme,
        end: ran.end,
        ticks: ran.ticks,
        statistics: &ran.statistics,
        spectrum: spectrum.as_ref(),
        energy: balance,
        comparison: comparison.as_ref(),
    });
    let document = page::document(&page::Content {
        plan: &plan,
        figures: &figures,
        scheme,
        samples: &ran.samples,
        points: ran.statistics.points(),
        spectrum: spectrum.as_ref(),
        energy: ran.energy.as_ref().map_or(&[], |book| &book.entries),
        comparison: comparison.as_ref(),
        replay: &replay(arguments),
    });
    let report = folder.file("report.html");
    write_text(&report, &html(&document))?;
    let json = output::json("figures", &figures)?;
    write_text(&folder.file("figures.json"), &json)?;
    Ok(Simulated { summary: terminal(&document), figures: json, report, history: [csv, log] })
}

/// Ticks between two kept samples.
fn every(plan: &Plan, wanted: Option<u32>) -> Outcome<u32> {
    let every = wanted.unwrap_or_else(|| plan.ticks.div_ceil(USUAL_SAMPLES)).max(1);
    let samples = plan.ticks / every + 1;
    if samples > MOST_SAMPLES {
        let least = plan.ticks.div_ceil(MOST_SAMPLES);
        return Err(Failure::new(format!("every {every} of {} ticks are {samples} samples", plan.ticks))
            .with_help(format!("give --every {least} or more, or a shorter --duration")));
    }
    Ok(every)
}

fn simulate<'a>(
    plan: &'a Plan,
    scheme: SchemeName,
    every: u32,
    with_energy: bool,
    files: &mut HistoryFiles<'_>,
    progress: &Progress,
) -> Outcome<Ran<'a>> {
    let books = with_energy.then(|| EnergyBook::open(plan.parameters(), plan.tick_rate, plan.ticks)).flatten();
    let mut ran =
        Ran { end: End::Whole, ticks: 0, samples: Vec::new(), statistics: Statistics::default(), energy: books };
    ran.end = follow::follow(&plan.run(), scheme, &mut |moment| {
        ran.ticks = moment.tick;
        if moment.tick.is_multiple_of(every) {
            files.write(moment)?;
            ran.samples.push(moment.clone());
        }
        if moment.tick >= plan.settle {
            ran.statistics.take(moment);
        }
        if let Some(book) = &mut ran.energy {
            book.take(moment);
        }
        if moment.tick.is_multiple_of(PROGRESS) {
            progress.at(moment.tick);
        }
        Ok(if interruption::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok(ran)
}

fn compare(plan: &Plan, every: u32, progress: &Progress) -> Outcome<Comparison> {
    // Every scheme and the disturbed reference go through all ticks.
    const RUNS: u32 = 1 + SchemeName::ALL.len() as u32;
    progress.run("comparing schemes", plan.ticks);
    comparison::compare(&plan.run(), every, &|done| {
        if (done / RUNS).is_multiple_of(PROGRESS) {
            progress.at(done / RUNS);
        }
    })
}

fn spectrum(plan: &Plan, samples: &[Moment], every: u32) -> Option<Spectrum> {
    let settled = samples.partition_point(|moment| moment.tick < plan.settle);
    let deflection = |moment: &Moment| moment.teeth.first().map_or(f64::NAN, |teeth| teeth.deflection);
    let signal: Vec<f64> = samples[settled..].iter().map(deflection).collect();
    Spectrum::of(&signal, f64::from(plan.tick_rate) / f64::from(every))
}

/// What the log says of itself.
fn remarks(arguments: &Arguments, plan: &Plan, scheme: SchemeName) -> BTreeMap<String, String> {
    [
        ("joint", plan.parameters().name.to_string()),
        ("joint_file", plan.name.clone()),
        ("scheme", scheme.name().to_owned()),
        ("tick_rate_hz", plan.tick_rate.to_string()),
        ("torques", plan.torques_name.clone()),
        ("command", replay(arguments)),
        ("version", VERSION.to_owned()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// The command that makes this run again.
fn replay(arguments: &Arguments) -> String {
    let mut command = format!("cargo joint sim {}", arguments::quoted(&arguments.file.display().to_string()));
    let scheme = match arguments.scheme {
        Choice::All => "all",
        other => other.shown().name(),
    };
    command += &format!(" --scheme {scheme}");
    command += &arguments.motion.replay();
    if let Some(every) = arguments.every {
        command += &format!(" --every {every}");
    }
    command
}

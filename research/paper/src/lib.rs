//! `joint paper`: repeats the study of He, Jia, Chen and Sun (2015), or runs it on another joint: stiffness wave, dead zone, attractors by
//! backlash, bifurcation diagram. The numerics are in `numerics`.
//!
//! `plan` validates the request, `files` checks that the report can be written; `study` computes, `oracle` checks with a second integrator,
//! `known` compares with known results, `pictures` and `page` present them.

mod conclusion;
mod dead_zone;
mod expectation;
mod files;
mod grid;
mod known;
pub mod numerics;
mod oracle;
mod page;
mod pictures;
mod plan;
mod record;
#[cfg(test)]
mod schema;
mod stiffness;
mod study;
mod windows;

use std::path::Path;

pub use plan::{Arguments, StartChoice, StudyJoint, StudyPlan, SweepStart};
pub use record::{
    AttractorRecord, Class, ClassWindow, DeadZoneError, DeadZoneFigure, History, Identity, Reading, SCHEMA_VERSION,
    Smoothed, SpectrumRecord, StiffnessFigure, StudyRecord, Sweep, SweepPoint,
};

use report::checks::all_hold;
use report::document::terminal;
use report::failure::Outcome;
use report::folder::{self, Folder};
use report::progress::Progress;
use report::provenance;
use report::{interruption, output};

/// Description of the command in a line of its help.
pub const ABOUT: &str = "Redo the paper, or the same study of another joint: attractors, bifurcation diagram, figures";

/// Runs the study; succeeds only if every check holds.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    interruption::watch()?;
    let plan = StudyPlan::new(arguments)?;
    let read: Vec<&Path> = arguments.file.as_deref().into_iter().collect();
    folder::check_files(&[("json", arguments.json.as_deref())], &read)?;
    output::keep_for_json(arguments.json.as_deref());
    let folder = Folder::prepare(arguments.out.as_deref(), "paper", plan.name(), &files::ALL)?;
    let progress = Progress::new();
    let studied = study(&plan, &progress);
    progress.clear();
    let record = interruption::explain(studied)?;
    let document = page::document(&record);
    let report = files::write(&folder, arguments.json.as_deref(), &record, &document)?;
    output::print(&terminal(&document))?;
    output::print(&format!("report: {}\n", report.display()))?;
    if let Some(expected) = &plan.expected {
        for reading in &record.readings {
            expectation::judge(&reading.joint, expected, &reading.attractors)?;
        }
    }
    all_hold(&record.checks, "the report shows each with its figure and bound")
}

/// Computes and checks a plan.
pub fn study(plan: &StudyPlan, progress: &Progress) -> Outcome<StudyRecord> {
    let date = provenance::date();
    let readings = study::run(plan, progress)?;
    let dead_zone = dead_zone::figure();
    let checks = known::checks(plan, &readings, &dead_zone);
    Ok(StudyRecord {
        schema_version: SCHEMA_VERSION,
        identity: Identity {
            joint: plan.name().to_owned(),
            replay: plan.replay.clone(),
            git_commit: provenance::git_commit(),
            host: provenance::host(),
            host_version: provenance::VERSION.to_owned(),
            date,
        },
        readings,
        stiffness: stiffness::figure(&plan.subjects[0].parameters),
        dead_zone,
        checks,
    })
}

//! `joint hil FILE.toml`: tests of observer and compensation that users write as files, run against the f64 reference or
//! the core's own plant, and reported. Observer and compensation run on the host or, by `board`, on a board.
//!
//! The order of a test: `file` reads what it says, `suite` finds it and its joint, `case` makes it concrete for a seed;
//! `execution` closes the loop between `plant` and `controller` through the faults of `injection`, with observer and
//! compensation behind `port`; `figures`, `values` and `sight` say what that was worth, `verdict` judges, `campaign` puts all seeds
//! together; `page`, `junit`, `log_file` and `record` are what stays.

pub mod board;
mod campaign;
pub mod case;
pub mod controller;
pub mod draw;
pub mod execution;
pub mod figures;
pub mod file;
pub mod injection;
mod junit;
mod log_file;
mod page;
mod pictures;
pub mod plant;
pub mod port;
mod pushes;
pub mod record;
pub mod recorded;
#[cfg(test)]
mod schema;
mod sender;
mod sight;
pub mod suite;
pub mod surroundings;
mod terminal;
mod trace;
pub mod values;
mod verdict;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU32;
use std::time::Instant;

use board::{BoardWish, Boards};
use campaign::{Conduct, Tested};
use plant::PlantName;
use record::{SCHEMA, TestsRecord};

use crate::failure::{Failure, Outcome};
use crate::hil::{Progress, origin};
use crate::output;
use crate::record::write_text;
use crate::sim::files::Folder;

/// What was asked for.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'w> {
    /// A test file, or a folder of them.
    pub path: &'w Path,
    /// One seed in place of the files'.
    pub seed: Option<u64>,
    /// What is controlled.
    pub plant: PlantName,
    /// The boards to run on; without them the host.
    pub boards: Option<BoardWish<'w>>,
    /// The full lists of seeds, and files that are only for those.
    pub full: bool,
    /// Folder for everything that stays.
    pub out: Option<&'w Path>,
    /// The results as JSON, too.
    pub json: Option<&'w Path>,
    /// The results as JUnit XML, too.
    pub junit: Option<&'w Path>,
}

/// Runs tests on the host; succeeds only if all passed.
pub fn run(wanted: &Wanted<'_>, progress: &Progress) -> Outcome<()> {
    let start = Instant::now();
    let tests = suite::load(wanted.path, wanted.full, wanted.plant)?;
    let boards = wanted.boards.map(|wish| Boards::prepare(wish, &tests, wanted.plant, progress)).transpose()?;
    let name = wanted.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = Folder::prepare(wanted.out, "hil/tests", &name)?;
    for path in [wanted.json, wanted.junit].into_iter().flatten() {
        if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty() && !parent.is_dir()) {
            return Err(Failure::new(format!("there is no folder {} for {}", parent.display(), path.display())));
        }
    }
    let logs = prepare_logs(&folder)?;
    let runs: usize =
        tests.iter().map(|test| test.seeds(wanted.seed, wanted.full).len() * test.controllers().len()).sum();
    progress.run("testing", runs as u32);
    let line = progress.handle();
    let conduct = Conduct {
        plant: wanted.plant,
        seed: wanted.seed,
        full: wanted.full,
        boards: boards.as_ref(),
        logs: &logs,
        done: &|runs| line.at(runs),
    };
    let before = AtomicU32::new(0);
    let mut tested: Vec<Tested> = Vec::new();
    for test in &tests {
        let one = campaign::run(test, &conduct, &before)?;
        progress.say_above(&terminal::line(&one.record));
        tested.push(one);
    }
    progress.clear();
    let record = TestsRecord {
        schema: SCHEMA.to_owned(),
        passed: tested.iter().all(|test| test.record.passed),
        on: boards.as_ref().map_or("host".to_owned(), Boards::label),
        plant: wanted.plant.word().to_owned(),
        full: wanted.full,
        host_version: env!("CARGO_PKG_VERSION").to_owned(),
        host: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        git_commit: origin::git_commit(),
        date: origin::date(),
        seconds: start.elapsed().as_secs_f64(),
        tests: tested.iter().map(|test| test.record.clone()).collect(),
    };
    output::print(&terminal::table(&record))?;
    write(wanted, &folder, &record, &tested)?;
    output::print(&format!("report: {}\n", folder.file("report.html").display()))?;
    verdict(&record)
}

/// An empty folder for logs: those of an older run would be taken for this one's.
fn prepare_logs(folder: &Folder) -> Outcome<PathBuf> {
    let logs = folder.file("runs");
    let failed = |error: std::io::Error| Failure::new(format!("cannot prepare {}: {error}", logs.display()));
    if logs.is_dir() {
        for entry in fs::read_dir(&logs).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|extension| extension == "mcap") {
                fs::remove_file(&path).map_err(failed)?;
            }
        }
    }
    fs::create_dir_all(&logs).map_err(failed)?;
    Ok(logs)
}

fn write(wanted: &Wanted<'_>, folder: &Folder, record: &TestsRecord, tested: &[Tested]) -> Outcome<()> {
    let json = output::json("results", record)?;
    let junit = junit::render(record);
    write_text(&folder.file("record.json"), &json)?;
    write_text(&folder.file("junit.xml"), &junit)?;
    write_text(&folder.file("report.html"), &page::render(record, tested))?;
    wanted.json.map_or(Ok(()), |path| write_text(path, &json))?;
    wanted.junit.map_or(Ok(()), |path| write_text(path, &junit))
}

fn verdict(record: &TestsRecord) -> Outcome<()> {
    let failed: Vec<&str> = record.tests.iter().filter(|test| !test.passed).map(|test| test.file.as_str()).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let message = format!("{} of {} tests failed: {}", failed.len(), record.tests.len(), failed.join(", "));
    Err(Failure::check_failed(message).with_help("the report leads with what failed, and how to run it again"))
}

//! `joint hil FILE.toml`: users' tests of observer and compensation, run against the f64 reference or the core's own
//! plant, with reports. Observer and compensation run on the host or, through `on_board`, on a board.
//!
//! Order of a test: `file` reads the test file, `suite` finds files and joints, `case` draws the values of one seed;
//! `execution` runs the case on the `rig`, which closes the loop between `plant` and `controller` through `faults`,
//! with observer and compensation behind `port`, and `run_history` stores the run; `metrics`, `values` and
//! `observer_metrics` compute the figures, `verdict` compares them with their bounds, `campaign` combines all seeds;
//! `task_runs` runs the seeds as tasks of a cluster; `page`, `junit`, `log_file` and `record` are the results on disk;
//! `controller_log` and `estimate_fields` are the controller's part of a log.

mod any_motion;
mod campaign;
pub mod case;
pub mod controller;
pub mod controller_log;
mod disturbances;
pub mod estimate_fields;
pub mod execution;
pub mod faults;
pub mod file;
mod junit;
pub mod log_file;
mod memory_file;
pub mod metrics;
mod observer_metrics;
pub mod on_board;
mod page;
mod pictures;
pub mod plant;
pub mod port;
pub mod record;
pub mod rig;
pub mod run_history;
#[cfg(test)]
mod schema;
pub mod set_point_source;
pub mod suite;
pub mod surroundings;
mod task_runs;
mod trace;
pub mod values;
mod verdict;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU32;
use std::time::Instant;

use live::{Live, PacedLiveOptions};

use campaign::{FinishedRuns, FinishedTest, RunOptions};
use on_board::{BoardRequest, Boards};
use plant::PlantName;
use rayon::prelude::*;
use record::{NotRun, SCHEMA, TestsRecord};
use suite::{Choice, Suite, Test};
use task_runs::TaskResults;

use report::document::{Document, html, terminal};
use report::failure::{EXIT_INTERRUPTED, Failure, Outcome};
use report::folder::{self, Folder};
use report::output;
use report::progress::Progress;
use report::provenance;
use report::seeds::Seeds;
use report::write::write_text;
pub use simulation::sim::live_view;
pub use simulation::{encoder_zeros, random, recorded};
pub use task_runs::{KIND, compute};
use tasks::EngineArguments;

/// Names of the page, of the results as JSON and as JUnit XML, and of the logs.
const REPORT: &str = "report.html";
const RECORD: &str = "record.json";
const JUNIT: &str = "junit.xml";
const LOGS: &str = "runs/*.mcap";
/// All files that tests write.
const FILES: [&str; 6] = [REPORT, RECORD, JUNIT, LOGS, memory_file::MEMORIES, memory_file::JOINTS];

/// A request to run tests.
#[derive(Debug, Clone)]
pub struct TestRequest<'w> {
    /// Groups of tests.
    pub groups: Vec<TestGroup<'w>>,
    /// Seeds in place of the files'.
    pub seed: Option<Seeds>,
    /// Runs the full lists of seeds.
    pub full: bool,
    /// Saves the estimated parameters after each run on the host.
    pub save_memories: bool,
    /// Name of the default output folder.
    pub name: String,
    /// Output folder in place of the default.
    pub out: Option<PathBuf>,
    /// Further file for the results as JSON.
    pub json: Option<&'w Path>,
    /// Further file for the results as JUnit XML.
    pub junit: Option<&'w Path>,
    /// Live view of the runs on the host, and of those in the role `observer`.
    pub live: PacedLiveOptions,
    /// Runs the seeds as tasks that are kept, on the host only.
    pub tasks: Option<TaskOptions>,
}

/// Options of runs as tasks.
#[derive(Debug, Clone)]
pub struct TaskOptions {
    /// Engine of the tasks.
    pub engine: EngineArguments,
    /// Command that goes on with the tasks in its own process.
    pub repeat: String,
}

/// Tests that run on one kind of board, or on the host.
#[derive(Debug, Clone)]
pub struct TestGroup<'w> {
    /// A test file, or a folder of test files.
    pub path: PathBuf,
    /// Choice among the files of a folder.
    pub choice: Choice,
    /// Model of the joint.
    pub plant: PlantName,
    /// Boards to run on; `None` runs on the host.
    pub boards: Option<BoardRequest<'w>>,
}

/// A group that is ready to run.
struct PreparedGroup<'w> {
    suite: Suite,
    plant: PlantName,
    boards: Option<Boards<'w>>,
}

/// Runs tests; fails unless all ran and passed.
pub fn run(request: &TestRequest<'_>, progress: &Progress) -> Outcome<()> {
    let start = Instant::now();
    let folder = Folder::choose(request.out.as_deref(), "hil/tests", &request.name, &FILES)?;
    // A port in use is reported before boards are prepared.
    let live = Live::start_paced(&request.live, "joint hil")?;
    let mut groups = Vec::new();
    for TestGroup { path, choice, plant, boards } in &request.groups {
        let mut suite = suite::load(path, *choice, *plant)?;
        let boards = boards.map(|request| Boards::prepare(request, &mut suite, *plant, progress)).transpose()?;
        groups.push(PreparedGroup { suite, plant: *plant, boards });
    }
    let read: Vec<PathBuf> = groups.iter().flat_map(|part| &part.suite.tests).flat_map(Test::files).collect();
    let read: Vec<&Path> = read.iter().map(PathBuf::as_path).collect();
    folder::check_files(&[("json", request.json), ("junit", request.junit)], &read)?;
    folder.make()?;
    folder::make(&folder.file(log_file::FOLDER))?;
    live.iter().for_each(|live| live.announce(progress));
    let finished = match &request.tasks {
        None => None,
        Some(options) => match task_runs::run(&groups, request, options, &folder, progress)? {
            TaskResults::Scripted(message) => return output::print(&message),
            TaskResults::Finished(runs) => Some(runs),
        },
    };
    let (tested, not_run) = run_groups(groups, request, &folder, live.as_ref(), finished.as_ref(), progress)?;
    let record = TestsRecord {
        schema: SCHEMA.to_owned(),
        passed: not_run.is_empty() && tested.iter().all(|test| test.record.passed),
        full: request.full,
        host_version: provenance::VERSION.to_owned(),
        host: provenance::host(),
        git_commit: provenance::git_commit(),
        date: provenance::date(),
        seconds: start.elapsed().as_secs_f64(),
        tests: tested.iter().map(|test| test.record.clone()).collect(),
        not_run,
    };
    let document = page::document(&record, &tested);
    output::print(&(terminal(&document) + "\n"))?;
    write(request, &folder, &record, &document)?;
    // Logs of an older run could be mistaken for this run's. If a test did not run, its older log is kept.
    if record.not_run.is_empty() {
        for files in [LOGS, memory_file::MEMORIES, memory_file::JOINTS] {
            folder.clear_older(files)?;
        }
    }
    output::print(&format!("report: {}\n", folder.file(REPORT).display()))?;
    verdict(&record)
}

/// Finished tests, and files that could not run.
type GroupResults = (Vec<FinishedTest>, Vec<NotRun>);

fn run_groups(
    groups: Vec<PreparedGroup<'_>>,
    request: &TestRequest<'_>,
    folder: &Folder,
    live: Option<&Live>,
    finished: Option<&FinishedRuns>,
    progress: &Progress,
) -> Outcome<GroupResults> {
    let runs_of = |test: &Test| test.seeds(request.seed, request.full).len() * test.controllers().len();
    let runs: usize = groups.iter().flat_map(|part| &part.suite.tests).map(runs_of).sum();
    progress.run("testing", runs as u32);
    let finished_runs = AtomicU32::new(0);
    let (mut tested, mut not_run) = (Vec::new(), Vec::new());
    for PreparedGroup { suite: Suite { tests, not_run: refused, .. }, plant, boards } in groups {
        not_run.extend(refused);
        let options = RunOptions {
            plant,
            seed: request.seed,
            full: request.full,
            boards: boards.as_ref(),
            save_memories: request.save_memories,
            live,
            folder,
            finished,
            done: &|runs| progress.set_position(runs),
        };
        let run = |test: &Test| {
            let outcome = campaign::run(test, &options, &finished_runs);
            outcome.iter().for_each(|finished| progress.print_above(&page::line(&finished.record)));
            outcome
        };
        // A test on the emulated board uses one core at most; a test on the host uses all cores.
        let emulated = boards.as_ref().is_some_and(Boards::are_emulated);
        let outcomes: Vec<Outcome<FinishedTest>> =
            if emulated { tests.par_iter().map(run).collect() } else { tests.iter().map(run).collect() };
        for (test, outcome) in tests.iter().zip(outcomes) {
            match outcome {
                Ok(finished) => tested.push(finished),
                Err(failure) if failure.exit_code() == EXIT_INTERRUPTED => return Err(failure),
                Err(failure) => not_run.push(NotRun::new(test.name.clone(), &failure)),
            }
        }
    }
    progress.clear();
    Ok((tested, not_run))
}

fn write(request: &TestRequest<'_>, folder: &Folder, record: &TestsRecord, document: &Document) -> Outcome<()> {
    let json = output::json("results", record)?;
    let junit = junit::render(record);
    folder.write_text(RECORD, &json)?;
    folder.write_text(JUNIT, &junit)?;
    folder.write_text(REPORT, &html(document))?;
    request.json.map_or(Ok(()), |path| output::write_json(path, &json))?;
    request.junit.map_or(Ok(()), |path| write_text(path, &junit))
}

fn verdict(record: &TestsRecord) -> Outcome<()> {
    let failed: Vec<&str> = record.tests.iter().filter(|test| !test.passed).map(|test| test.file.as_str()).collect();
    let all = record.tests.len() + record.not_run.len();
    let not_run = match record.not_run.as_slice() {
        [] => None,
        [test] => Some(format!("{} was not run: {}", test.file, test.why)),
        many => {
            let files: Vec<&str> = many.iter().map(|test| test.file.as_str()).collect();
            Some(format!("{} of {all} tests were not run: {}", many.len(), files.join(", ")))
        }
    };
    match (failed.is_empty(), not_run) {
        (true, None) => Ok(()),
        (true, Some(not_run)) => {
            let remedy =
                record.not_run.first().and_then(|test| test.remedy.clone()).filter(|_| record.not_run.len() == 1);
            Err(Failure::new(not_run)
                .with_help(remedy.unwrap_or_else(|| "each is named above with its reason".to_owned())))
        }
        (false, not_run) => {
            let mut message = format!("{} of {all} tests failed: {}", failed.len(), failed.join(", "));
            not_run.iter().for_each(|not_run| message += &format!("; {not_run}"));
            Err(Failure::check_failed(message).with_help("the report leads with what failed, and how to run it again"))
        }
    }
}

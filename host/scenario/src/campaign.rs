//! Runs one test: every seed and every controller, on all cores. The results do not depend on the order of completion.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use live::Live;
use rayon::prelude::*;

use super::controller::ControllerName;
use super::controller_log::ObserverOrigin;
use super::execution::{RunSpec, Watch, execute};
use super::file::{Aggregate, fault_word};
use super::log_file::{self, LoggedRun};
use super::memory_file;
use super::on_board::Boards;
use super::plant::PlantName;
use super::record::{AssertionRecord, BandwidthRecord, TestRecord, TestRun};
use super::rig::RunError;
use super::suite::Test;
use super::trace::Trace;
use super::values::MetricValues;
use super::verdict::{Results, check_assertions};
use report::checks::Verdict;
use report::command_line::{program, quoted};
use report::failure::{Failure, Outcome};
use report::folder::Folder;
use report::seeds::Seeds;
use simulation::bandwidth::Bandwidth;

/// Options of a run of tests.
pub struct RunOptions<'c> {
    /// Model of the joint.
    pub plant: PlantName,
    /// Seeds in place of the file's.
    pub seed: Option<Seeds>,
    /// Runs the full lists of seeds.
    pub full: bool,
    /// Boards for the tested controller; `None` runs it on the host.
    pub boards: Option<&'c Boards<'c>>,
    /// Saves the estimated parameters after each run, as a board does.
    pub save_memories: bool,
    /// Live view of the tested controller's runs.
    pub live: Option<&'c Live>,
    /// Folder of the logs.
    pub folder: &'c Folder,
    /// Runs that tasks have finished; `None` computes the runs here.
    pub finished: Option<&'c FinishedRuns>,
    /// Called after every run with the number of finished runs.
    pub done: &'c (dyn Fn(u32) + Sync),
}

/// A finished test: its record, and the data of its pictures.
pub struct FinishedTest {
    /// Record that is written.
    pub record: TestRecord,
    /// Runs of the shown seed, in the order of the record's controllers.
    pub shown: Vec<(ControllerName, Trace)>,
    /// Words of the faults, with their start and end times [s].
    pub faults: Vec<(&'static str, [f64; 2])>,
}

#[derive(Clone, Copy)]
struct Job {
    seed: u64,
    controller: ControllerName,
    /// Keeps the log and the data of the pictures.
    keep_logs: bool,
}

/// Largest number of seeds for which every run leaves a log of some megabytes. Above, only the shown seed does;
/// `--seed` repeats any run.
const MAX_LOGGED_SEEDS: usize = 100;

/// Runs of tasks by test, seed and controller.
pub type FinishedRuns = BTreeMap<(String, u64, String), TestRun>;

struct FinishedRun {
    values: Option<MetricValues>,
    run: TestRun,
    /// Data of the pictures, if kept.
    trace: Option<Trace>,
}

impl Test {
    /// Seeds of a run.
    pub fn seeds(&self, seed: Option<Seeds>, full: bool) -> Vec<u64> {
        match (seed, full) {
            (Some(seeds), _) => seeds.each().collect(),
            (None, true) => self.file.full_seeds.clone(),
            (None, false) => self.file.seeds.clone(),
        }
    }

    /// Returns true if every run leaves a log; otherwise only those of the shown seed do.
    pub fn keeps_logs(&self, seed: Option<Seeds>, full: bool) -> bool {
        self.seeds(seed, full).len() <= MAX_LOGGED_SEEDS
    }

    /// Controllers, the tested one first.
    pub fn controllers(&self) -> Vec<ControllerName> {
        std::iter::once(self.file.controller).chain(self.file.rivals.iter().copied()).collect()
    }
}

/// Runs a test.
pub fn run(test: &Test, options: &RunOptions<'_>, finished_runs: &AtomicU32) -> Outcome<FinishedTest> {
    let start = Instant::now();
    let watch = Watch::until(start + Duration::from_secs_f64(test.file.timeout)).beside(options.live);
    let seeds = test.seeds(options.seed, options.full);
    let controllers = test.controllers();
    let keep_logs = test.keeps_logs(options.seed, options.full);
    let job = |seed: u64| controllers.iter().map(move |controller| Job { seed, controller: *controller, keep_logs });
    let jobs: Vec<Job> = seeds.iter().flat_map(|seed| job(*seed)).collect();
    let computed = |job: &Job| {
        let done = match options.finished {
            Some(finished) => finished_run(test, finished, job),
            None => run_job(test, options, job, watch),
        };
        (options.done)(finished_runs.fetch_add(1, Ordering::Relaxed) + 1);
        done
    };
    let done: Vec<Outcome<FinishedRun>> = jobs.par_iter().map(computed).collect();
    let done: Vec<FinishedRun> = done.into_iter().collect::<Outcome<_>>()?;
    let places: BTreeMap<u64, usize> = seeds.iter().enumerate().map(|(place, seed)| (*seed, place)).collect();
    let values_of = |seed: u64, controller: ControllerName| {
        let place = places.get(&seed)? * controllers.len() + controllers.iter().position(|name| *name == controller)?;
        done[place].values.clone()
    };
    let assertions = check_assertions(&test.file, &Results { seeds: &seeds, values_of: &values_of });
    // If the tested controller's run breaks off, the test fails; a rival's broken run only costs its figures.
    let own = |(job, done): (&Job, &FinishedRun)| {
        let why = done.run.broken.as_ref().filter(|_| job.controller == test.file.controller)?;
        Some((job.seed, format!("seed {}: {why}", job.seed)))
    };
    let broken: Vec<(u64, String)> = jobs.iter().zip(&done).filter_map(own).collect();
    let failed: Vec<&AssertionRecord> =
        assertions.iter().filter(|assertion| assertion.verdict == Verdict::Failed).collect();
    let broken_seed = broken.first().map(|(seed, _)| *seed);
    let shown_seed = failed.first().and_then(|failed| failed.seed).or(broken_seed).or(seeds.first().copied());
    let shown_seed = shown_seed.unwrap_or_default();
    let passed = failed.is_empty() && broken.is_empty();
    let replay = replay_command(test, options, single_failing_seed(&failed, &broken));
    let mut runs = Vec::new();
    let mut shown = Vec::new();
    for (job, mut done) in jobs.iter().zip(done) {
        if job.seed == shown_seed {
            // Without `keep_logs`, log and pictures of the run were not kept, and a task keeps no pictures: the run is
            // repeated to record them.
            if !keep_logs || options.finished.is_some() {
                let again = run_job(test, options, &Job { keep_logs: true, ..*job }, watch)?;
                check_same(test, &done.run, &again.run)?;
                done = again;
            }
            shown.push((job.controller, done.trace.unwrap_or_default()));
        }
        runs.push(done.run);
    }
    let record = TestRecord {
        file: test.name.clone(),
        file_sha256: test.sha256.clone(),
        title: test.file.title.clone(),
        joint: test.joint.file.parameters.name.to_string(),
        joint_sha256: test.joint_sha256(),
        on: options.boards.map_or("host".to_owned(), Boards::label),
        plant: options.plant.word().to_owned(),
        profile: test.file.profile.kind.to_owned(),
        controller: test.file.controller.word().to_owned(),
        bandwidth: bandwidth_record(test, shown_seed),
        duration_s: test.file.duration,
        settle_s: test.file.settle,
        faults: test.file.faults.iter().map(|fault| fault_word(fault).to_owned()).collect(),
        seeds,
        passed,
        broken: broken.into_iter().next().map(|(_, why)| why),
        assertions,
        runs,
        shown_seed,
        replay,
        seconds: start.elapsed().as_secs_f64(),
    };
    let faults = test.file.faults.iter().map(|fault| (fault_word(fault), [fault.start, fault.end])).collect();
    Ok(FinishedTest { record, shown, faults })
}

/// Runs all controllers of one seed for a task.
pub fn run_seed(test: &Test, options: &RunOptions<'_>, seed: u64, keep_logs: bool) -> Outcome<Vec<TestRun>> {
    let watch = Watch::until(Instant::now() + Duration::from_secs_f64(test.file.timeout));
    let run = |controller| {
        let run = run_job(test, options, &Job { seed, controller, keep_logs }, watch)?.run;
        // A slow machine is no property of the run, so it is no result.
        match run.broken.as_ref().filter(|why| **why == RunError::TimedOut.to_string()) {
            Some(why) => Err(Failure::new(format!("{}: seed {seed}: {why}", test.name))
                .with_help("raise timeout_s in the test file, or run fewer tasks at once on a machine")),
            None => Ok(run),
        }
    };
    test.controllers().into_iter().map(run).collect()
}

/// Run that a task has finished.
fn finished_run(test: &Test, finished: &FinishedRuns, job: &Job) -> Outcome<FinishedRun> {
    let key = (test.name.clone(), job.seed, job.controller.word().to_owned());
    let run = finished.get(&key).cloned().ok_or_else(|| {
        Failure::new(format!("{}: no task has run {} in seed {}", test.name, key.2, job.seed))
            .with_help("remove the folder tasks and run the same command again")
    })?;
    let values = run.broken.is_none().then(|| MetricValues::from_figures(&run.figures));
    Ok(FinishedRun { values, run, trace: None })
}

/// Refuses a run that gives other bits here than on the machine that ran it first.
fn check_same(test: &Test, first: &TestRun, again: &TestRun) -> Outcome<()> {
    if (&first.digest, &first.figures) == (&again.digest, &again.figures) {
        return Ok(());
    }
    let (seed, controller) = (first.seed, &first.controller);
    Err(Failure::new(format!(
        "{}: {controller} in seed {seed} has the digest {} from a task, and {} here",
        test.name, first.digest, again.digest
    ))
    .with_help("a machine of the cluster computes other bits: compare `joint task` on its nodes"))
}

/// Bandwidth of a test's compensation in a seed.
fn bandwidth_record(test: &Test, seed: u64) -> Option<BandwidthRecord> {
    if !test.file.controller.is_compensation() || test.file.controller == ControllerName::Probe {
        return None;
    }
    let case = test.case(seed).ok()?;
    let range = Bandwidth::for_joint(&case.nominal, &case.nominal_surroundings)?;
    Some(BandwidthRecord {
        used_rad_per_s: case.bandwidth(&test.file).ok()?,
        asked: test.file.bandwidth.is_some(),
        widest_rad_per_s: range.widest_rad_per_s,
        limited_by: range.limited_by,
    })
}

/// The only seed that shows every failure, if there is one; figures over several seeds need all of them.
fn single_failing_seed(failed: &[&AssertionRecord], broken: &[(u64, String)]) -> Option<u64> {
    let of_one =
        failed.iter().map(|assertion| assertion.seed.filter(|_| assertion.aggregate == Aggregate::Worst.word()));
    let mut seeds = of_one.chain(broken.iter().map(|(seed, _)| Some(*seed)));
    let first = seeds.next()??;
    seeds.all(|seed| seed == Some(first)).then_some(first)
}

/// Command that repeats the failures; with a seed, only that seed's.
fn replay_command(test: &Test, options: &RunOptions<'_>, alone: Option<u64>) -> String {
    let place = options.boards.map_or("--host".to_owned(), Boards::arguments);
    let alone = alone.map(|seed| Seeds { first: seed, last: seed });
    let seeds = match (alone.or(options.seed), options.full) {
        (Some(seed), _) => format!(" --seed {seed}"),
        (None, true) => " --full".to_owned(),
        (None, false) => String::new(),
    };
    let (command, name) = (program(), quoted(&test.name));
    format!("{command} hil {name} {place} --plant {}{seeds}", options.plant.word())
}

fn run_job(test: &Test, options: &RunOptions<'_>, job: &Job, watch: Watch<'_>) -> Outcome<FinishedRun> {
    let mut case = test.case(job.seed)?;
    // A log carries the joint file of its observer. A nominal joint outside the limits of joint files is run anyway if
    // no board or memory needs the file.
    if let Err(refused) = case.round_nominal()
        && (options.boards.is_some() || options.save_memories)
    {
        return Err(refused);
    }
    let spec = RunSpec { controller: job.controller, plant: options.plant, without_gap: false };
    let mut run = TestRun {
        seed: job.seed,
        controller: job.controller.word().to_owned(),
        drawn: case.drawn.clone(),
        ..TestRun::default()
    };
    let is_tested = job.controller == test.file.controller;
    let name = format!("{}, seed {}", test.name, job.seed);
    let history = match options.boards.filter(|_| is_tested) {
        None => execute(&test.file, &case, job.seed, spec, watch.named(is_tested.then_some(&name))),
        Some(boards) => boards.run(test, &case, job.seed, spec, watch.named(Some(&name))).map(|(history, board)| {
            run.board = Some(board);
            history
        }),
    };
    let both = history.and_then(|history| {
        let wanted = test.file.gains.is_some() && job.controller.wants_gains();
        let other = RunSpec { controller: job.controller.without_gap(), without_gap: true, ..spec };
        let without_gap = wanted.then(|| execute(&test.file, &case, job.seed, other, watch)).transpose()?;
        Ok((history, without_gap))
    });
    match both {
        Ok((history, without_gap)) => {
            let values = MetricValues::compute(&test.file, &case, &history, without_gap.as_ref());
            run.refusal = history.refusal().map(|refusal| refusal.to_string());
            run.digest = format!("{:016x}", history.digest);
            run.figures = values.available().map(|(metric, value)| (metric.name(), value)).collect();
            let name = format!("{}-seed{}-{}.mcap", test.stem(), job.seed, run.controller);
            let remarks = [
                ("test", test.name.clone()),
                ("joint", case.nominal.name.to_string()),
                ("seed", job.seed.to_string()),
                ("controller", run.controller.clone()),
                ("plant", options.plant.word().to_owned()),
                ("digest", run.digest.clone()),
            ];
            let mut remarks: BTreeMap<_, _> = remarks.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
            let origin = case.observer_origin(&test.file, history.memory_at_start);
            remarks
                .extend(origin.filter(|_| job.controller.is_compensation()).iter().flat_map(ObserverOrigin::remarks));
            let logged = LoggedRun { history: &history, faults: &test.file.faults, every_period: is_tested, remarks };
            if job.keep_logs {
                run.log = Some(log_file::write(options.folder, &name, logged)?);
            }
            if let Some(memory) = history.memory.filter(|_| options.save_memories) {
                let name = name.trim_end_matches(".mcap");
                run.memory = Some(memory_file::write(options.folder, name, &memory, &case.nominal_text()?)?);
            }
            Ok(FinishedRun { values: Some(values), run, trace: job.keep_logs.then(|| Trace::from_history(&history)) })
        }
        Err(RunError::Refused(failure)) => Err(failure.while_doing(&test.name)),
        Err(RunError::Interrupted) => Err(Failure::interrupted("stopped by the user")),
        Err(error) => {
            run.broken = Some(error.to_string());
            Ok(FinishedRun { values: None, run, trace: None })
        }
    }
}

//! Seeds of tests as tasks, on the host: each task runs all controllers of some seeds from the texts of the test alone.
//! Its result has the runs of the record as JSON in one line, then the bytes of their logs and memories.

use std::fs;
use std::io::Write;

use clap::Parser;

use super::campaign::{self, FinishedRuns, RunOptions};
use super::log_file;
use super::plant::PlantName;
use super::record::TestRun;
use super::suite;
use super::{FILES, PreparedGroup, TaskOptions, TestRequest};
use report::failure::Outcome;
use report::folder::{self, Folder};
use report::interruption::UninterruptedWork;
use report::progress::Progress;
use tasks::{Execution, MAX_TASKS, Progressed, Task, TaskFolder, TaskList, package};

/// Kind of the tasks of tests.
pub const KIND: &str = "hil";
/// Folder of the tasks in the output folder.
const TASKS: &str = "tasks";

/// Command line of a task; its inputs are those of the test.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct Line {
    /// Test, as the user named it.
    #[arg(long)]
    test: String,
    /// Joint, as the test names it.
    #[arg(long)]
    joint: String,
    /// Model of the joint.
    #[arg(long, value_enum)]
    plant: PlantName,
    /// Keeps the log of every run.
    #[arg(long)]
    logs: bool,
    /// Saves the estimated parameters after each run.
    #[arg(long)]
    memories: bool,
    /// Seeds.
    #[arg(long, value_delimiter = ',')]
    seeds: Vec<u64>,
}

/// Outcome of the tasks.
pub enum TaskResults {
    /// All runs.
    Finished(FinishedRuns),
    /// The job script is written; the message names the next commands.
    Scripted(String),
}

/// Runs all tests as tasks, or writes their job script. Logs and memories go to the output folder.
pub fn run(
    groups: &[PreparedGroup<'_>],
    request: &TestRequest<'_>,
    options: &TaskOptions,
    folder: &Folder,
    progress: &Progress,
) -> Outcome<TaskResults> {
    // Tasks in progress are still stored when the user stops the run.
    let _uninterrupted = UninterruptedWork::begin();
    let tasks = TaskFolder::prepare(&folder.file(TASKS), list(groups, request))?;
    let execution =
        Execution { engine: &options.engine, threads: None, repeat: options.repeat.clone(), compute: &compute };
    if let Progressed::Scripted(message) = tasks.run(&execution, progress)? {
        return Ok(TaskResults::Scripted(message));
    }
    let mut runs = FinishedRuns::new();
    for task in tasks.list().tasks() {
        let Line { test, .. } = task.parse()?;
        let (of_task, files) = tasks.read(task, package::unpack::<Vec<TestRun>>)?;
        for (name, bytes) in files {
            folder.write_with(&name, |file| file.write_all(&bytes))?;
        }
        runs.extend(of_task.into_iter().map(|run| ((test.clone(), run.seed, run.controller.clone()), run)));
    }
    Ok(TaskResults::Finished(runs))
}

/// Tasks of all tests. How seeds are grouped depends on the request only, so that every engine goes on with the results
/// of every other.
fn list(groups: &[PreparedGroup<'_>], request: &TestRequest<'_>) -> TaskList {
    let mut list = TaskList::new(KIND);
    let tests = groups.iter().map(|group| group.suite.tests.len()).sum::<usize>().max(1);
    let most_of_test = (MAX_TASKS / tests).max(1);
    for (test, plant) in groups.iter().flat_map(|group| group.suite.tests.iter().map(|test| (test, group.plant))) {
        let inputs: Vec<String> = test.inputs.iter().map(|text| list.add_input(text.clone())).collect();
        let seeds = test.seeds(request.seed, request.full);
        for some in seeds.chunks(seeds.len().div_ceil(most_of_test).max(1)) {
            let some: Vec<String> = some.iter().map(u64::to_string).collect();
            let mut words = vec![
                format!("--test={}", test.name),
                format!("--joint={}", test.joint.name),
                format!("--plant={}", plant.word()),
                format!("--seeds={}", some.join(",")),
            ];
            words.extend(test.keeps_logs(request.seed, request.full).then(|| "--logs".to_owned()));
            words.extend(request.save_memories.then(|| "--memories".to_owned()));
            list.add_task(inputs.clone(), words);
        }
    }
    list
}

/// Computes a task from its inputs alone, on any machine.
pub fn compute(tasks: &TaskFolder, task: &Task) -> Outcome<Vec<u8>> {
    let Line { test, joint, plant, logs, memories, seeds } = task.parse()?;
    let test = suite::from_inputs(&test, &tasks.list().inputs_of(task), &joint, plant)?;
    let place = tasks.path().join(format!("{}.work", task.digest()));
    // A killed process has left its logs.
    let _ = fs::remove_dir_all(&place);
    let work = Folder::prepare(Some(&place), KIND, &joint, &FILES)?;
    folder::make(&work.file(log_file::FOLDER))?;
    let options = RunOptions {
        plant,
        seed: None,
        full: false,
        boards: None,
        save_memories: memories,
        live: None,
        folder: &work,
        finished: None,
        done: &|_| {},
    };
    let runs: Outcome<Vec<Vec<TestRun>>> =
        seeds.iter().map(|seed| campaign::run_seed(&test, &options, *seed, logs)).collect();
    let packed = runs.map(|runs| runs.concat()).and_then(|runs| {
        let files = runs.iter().flat_map(files_of).collect();
        package::pack(&runs, &place, files)
    });
    // What stays is removed before the next run of this task.
    let _ = fs::remove_dir_all(&place);
    packed
}

/// Files of a run.
fn files_of(run: &TestRun) -> Vec<String> {
    let memory = run.memory.iter().flat_map(|name| [name.clone(), name.replace(".memory", ".toml")]);
    run.log.iter().cloned().chain(memory).collect()
}

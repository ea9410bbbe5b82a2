//! `joint task`: runs one task of a folder, as an element of a job array or a worker does.

use std::path::PathBuf;

use report::failure::{Failure, Outcome};
use report::interruption::{UninterruptedWork, explain, watch};
use report::output;
use simulation::sweep;
use tasks::{Task, TaskFolder};

/// Arguments of `joint task`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  joint task bifurcation/tasks --number 7     the task 7, unless it has its result already

The result is <digest>.result in the folder, written completely or not at all.

Exit code: 0 if the task has its result, 2 for bad input or a bad environment, 130 after Ctrl-C.")]
pub struct Arguments {
    /// Folder `tasks` that a sweep, or `joint hil` with --resume, --dask or --slurm, has made
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Number of the task, from 0
    #[arg(long, value_name = "N")]
    number: usize,
}

/// Runs the task and prints the path of its result.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    watch()?;
    let folder = TaskFolder::open(&arguments.folder)?;
    // A result that is being written is completed when the user stops the run.
    let _uninterrupted = UninterruptedWork::begin();
    let path = explain(folder.run_task(arguments.number, &compute))?;
    output::print(&format!("result: {}\n", path.display()))
}

fn compute(folder: &TaskFolder, task: &Task) -> Outcome<Vec<u8>> {
    match folder.list().kind() {
        sweep::KIND => sweep::compute(folder, task),
        scenario::KIND => scenario::compute(folder, task),
        kind => Err(Failure::new(format!("tasks of the kind `{kind}` are unknown"))
            .with_help("run the command again that made the tasks")),
    }
}

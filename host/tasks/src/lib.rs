//! Runs as tasks that can be repeated. A task is a command line with the texts of its inputs; its digest covers both and
//! the program. Its result is one file named by the digest, written completely or not at all: a task with a result is not
//! run again, and a killed worker loses its task only.
//!
//! `list` defines tasks, `folder` keeps them with their results and runs those that are left: on this machine, through
//! `dask` on the workers of a scheduler, or later by the job script of `slurm`. `program` identifies the program,
//! `package` is a result with files.

mod dask;
mod folder;
mod list;
pub mod package;
pub mod program;
mod slurm;

pub use folder::{Compute, Execution, Progressed, TaskFolder};
pub use list::{MAX_TASKS, Task, TaskList};

/// Engine that runs the tasks; without an option, this process.
#[derive(Debug, Clone, Default, PartialEq, Eq, clap::Args)]
pub struct EngineArguments {
    /// Runs the tasks on the workers of a Dask scheduler, named by its address, such as tcp://10.0.0.5:8786, or by its
    /// scheduler file; needs Python with the packages lostmotion and distributed
    #[arg(long, value_name = "ADDRESS|FILE", conflicts_with = "slurm")]
    pub dask: Option<String>,
    /// Writes a SLURM job script for the tasks that are left and runs none of them; after the job, the same command
    /// without --slurm collects the results
    #[arg(long)]
    pub slurm: bool,
}

impl EngineArguments {
    /// Returns true if another engine than this process is named.
    pub fn is_cluster(&self) -> bool {
        self.slurm || self.dask.is_some()
    }
}

//! Folder of tasks: `list.json`, and a result for each finished task, named by the task's digest.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use report::failure::{EXIT_INTERRUPTED, Failure, Outcome};
use report::progress::Progress;
use report::write::write_bytes;
use report::{folder, interruption, output};

use crate::list::{Task, TaskList};
use crate::{EngineArguments, dask, slurm};
use report::digest::sha256;

/// Name of the list.
const LIST: &str = "list.json";
/// First word of every result.
const HEAD: &str = "joint-result/1";

/// Computes the result of a task of this folder.
pub type Compute<'c> = &'c (dyn Fn(&TaskFolder, &Task) -> Outcome<Vec<u8>> + Sync);

/// A folder of tasks.
#[derive(Debug)]
pub struct TaskFolder {
    path: PathBuf,
    list: TaskList,
}

/// Way to run the tasks that are left.
pub struct Execution<'e> {
    /// Engine.
    pub engine: &'e EngineArguments,
    /// Number of threads in this process; `None` for the number of processors.
    pub threads: Option<u16>,
    /// Command that goes on with the tasks in this process.
    pub repeat: String,
    /// Computes a task in this process.
    pub compute: Compute<'e>,
}

/// Outcome of an execution.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Progressed {
    /// Every task has a result.
    Complete,
    /// The job script is written; the message names the next commands.
    Scripted(String),
}

impl TaskFolder {
    /// Creates or continues a folder; results of equal tasks are kept.
    pub fn prepare(path: &Path, list: TaskList) -> Outcome<Self> {
        folder::make(path)?;
        let text = list.text();
        let file = path.join(LIST);
        if fs::read(&file).is_ok_and(|found| found == text.as_bytes()) {
            return Ok(Self { path: path.to_owned(), list });
        }
        write_bytes(&file, text.as_bytes())?;
        Ok(Self { path: path.to_owned(), list })
    }

    /// Opens a folder that a command of this program has made.
    pub fn open(path: &Path) -> Outcome<Self> {
        let list = TaskList::read(&path.join(LIST))?;
        Ok(Self { path: path.to_owned(), list })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Tasks of the folder.
    pub fn list(&self) -> &TaskList {
        &self.list
    }

    /// Path of a task's result.
    pub fn result_path(&self, task: &Task) -> PathBuf {
        self.path.join(format!("{}.result", task.digest()))
    }

    /// Result of a finished task; `None` for a task without result, and for a damaged result.
    pub fn result(&self, task: &Task) -> Option<Vec<u8>> {
        let mut bytes = fs::read(self.result_path(task)).ok()?;
        let end = bytes.iter().position(|byte| *byte == b'\n')? + 1;
        let body = bytes.split_off(end);
        (bytes == head(task, &body).as_bytes()).then_some(body)
    }

    /// Result of a task of a complete execution, as `read` understands it.
    pub fn read<T>(&self, task: &Task, read: impl FnOnce(&[u8]) -> Option<T>) -> Outcome<T> {
        self.result(task).as_deref().and_then(read).ok_or_else(|| {
            Failure::new(format!("{} is not the result of its task", self.result_path(task).display()))
                .with_help("remove it and run the same command again, which runs the task anew")
        })
    }

    /// Numbers of the tasks without a valid result.
    pub fn missing(&self) -> Vec<usize> {
        let tasks = self.list.tasks();
        (0..tasks.len()).into_par_iter().filter(|number| self.result(&tasks[*number]).is_none()).collect()
    }

    /// Runs one task and writes its result, unless it has one.
    pub fn run_task(&self, number: usize, compute: Compute<'_>) -> Outcome<PathBuf> {
        let tasks = self.list.tasks();
        let task = tasks.get(number).ok_or_else(|| {
            Failure::new(format!("there is no task {number} in {}", self.path.display()))
                .with_help(format!("its {} tasks are numbered from 0", tasks.len()))
        })?;
        if self.result(task).is_none() {
            let body = compute(self, task)?;
            write_bytes(&self.result_path(task), &[head(task, &body).as_bytes(), &body].concat())?;
        }
        Ok(self.result_path(task))
    }

    /// Runs the tasks without a result, or writes their job script.
    pub fn run(&self, execution: &Execution<'_>, progress: &Progress) -> Outcome<Progressed> {
        let missing = self.missing();
        let (all, kept) = (self.list.tasks().len(), self.list.tasks().len() - missing.len());
        if kept > 0 {
            output::remark(&format!("continuing: {kept} of {all} tasks are in {}", self.path.display()));
        }
        if execution.engine.slurm {
            return slurm::write(&self.path, &missing, &execution.repeat).map(Progressed::Scripted);
        }
        if missing.is_empty() {
            return Ok(Progressed::Complete);
        }
        progress.run("running tasks", missing.len() as u64);
        let ended = match &execution.engine.dask {
            Some(address) => self.run_on_dask(address, &missing, progress),
            None => self.run_here(&missing, execution, progress),
        };
        progress.clear();
        let left = self.missing().len();
        match ended {
            Ok(()) if left == 0 => Ok(Progressed::Complete),
            Ok(()) => Err(Failure::new(format!("{left} of {all} tasks have no result in {}", self.path.display()))
                .with_help(format!("run them with this command:\n{}", execution.repeat))),
            Err(failure) if failure.exit_code() == EXIT_INTERRUPTED => Err(Failure::interrupted(format!(
                "stopped by the user: {left} of {all} tasks are left"
            ))
            .with_help(format!(
                "all others are kept in {}; run this command to continue:\n{}",
                self.path.display(),
                execution.repeat
            ))),
            Err(failure) => {
                let kept = format!("{} of {all} tasks are kept: run the same command again", all - left);
                let help = failure.full_help().map_or_else(|| kept.clone(), |help| format!("{help}; {kept}"));
                Err(failure.with_help(help))
            }
        }
    }

    fn run_here(&self, missing: &[usize], execution: &Execution<'_>, progress: &Progress) -> Outcome<()> {
        let threads = execution.threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
            Failure::new(format!("cannot start {threads} threads: {error}")).with_help("give fewer --threads")
        })?;
        pool.install(|| {
            // Threads take tasks one by one, so that no thread idles behind a slow one.
            missing.par_iter().with_max_len(1).try_for_each(|number| {
                if interruption::requested() {
                    return Err(Failure::interrupted("stopped by the user"));
                }
                self.run_task(*number, execution.compute)?;
                progress.advance(1);
                Ok(())
            })
        })
    }

    fn run_on_dask(&self, address: &str, missing: &[usize], progress: &Progress) -> Outcome<()> {
        for number in missing {
            // The client takes every file with a task's digest for its result.
            let _ = fs::remove_file(self.result_path(&self.list.tasks()[*number]));
        }
        dask::run(address, &self.path, progress)
    }
}

/// First line of a result.
fn head(task: &Task, body: &[u8]) -> String {
    format!("{HEAD} {} {}\n", task.digest(), sha256(body))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn list(count: usize) -> TaskList {
        let mut list = TaskList::new("test");
        let input = list.add_input("text".to_owned());
        (0..count).for_each(|number| list.add_task(vec![input.clone()], vec![number.to_string()]));
        list
    }

    fn body(_: &TaskFolder, task: &Task) -> Outcome<Vec<u8>> {
        Ok(format!("result of {}", task.arguments()[0]).into_bytes())
    }

    fn run(folder: &TaskFolder, engine: &EngineArguments, compute: Compute<'_>) -> Outcome<Progressed> {
        let execution = Execution { engine, threads: Some(2), repeat: "joint again".to_owned(), compute };
        folder.run(&execution, &Progress::new())
    }

    /// A finished task is not run again; a missing, cut or altered result is.
    #[test]
    fn only_tasks_without_valid_result_run() {
        let place = tempfile::tempdir().expect("a folder");
        let folder = TaskFolder::prepare(place.path(), list(5)).expect("room");
        let runs = AtomicUsize::new(0);
        let count = |folder: &TaskFolder, task: &Task| {
            runs.fetch_add(1, Ordering::SeqCst);
            body(folder, task)
        };
        let again = |wanted: usize| {
            runs.store(0, Ordering::SeqCst);
            let ended = run(&folder, &EngineArguments::default(), &count).expect("nothing fails");
            assert_eq!((ended, runs.load(Ordering::SeqCst)), (Progressed::Complete, wanted));
            for (number, task) in folder.list().tasks().iter().enumerate() {
                assert_eq!(folder.result(task), Some(format!("result of {number}").into_bytes()));
            }
        };
        again(5);
        again(0);
        let paths: Vec<PathBuf> = folder.list().tasks().iter().map(|task| folder.result_path(task)).collect();
        fs::remove_file(&paths[0]).expect("there");
        let whole = fs::read(&paths[1]).expect("there");
        fs::write(&paths[1], &whole[..whole.len() - 1]).expect("room");
        fs::write(&paths[2], String::from_utf8_lossy(&whole).replace("of 1", "of 2")).expect("room");
        fs::write(&paths[3], "").expect("room");
        again(4);
    }

    /// A failing task ends the run; every finished task stays.
    #[test]
    fn failed_task_keeps_the_others() {
        let place = tempfile::tempdir().expect("a folder");
        let folder = TaskFolder::prepare(place.path(), list(3)).expect("room");
        let fail = |folder: &TaskFolder, task: &Task| match task.arguments()[0].as_str() {
            "1" => Err(Failure::new("tooth 1 is gone").with_help("mount another")),
            _ => body(folder, task),
        };
        let failure = run(&folder, &EngineArguments::default(), &fail).expect_err("task 1 fails");
        assert!(failure.message().contains("tooth 1 is gone") && failure.exit_code() == 2, "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("mount another") && help.contains("are kept")));
        assert!(folder.missing().contains(&1));
        assert_eq!(run(&folder, &EngineArguments::default(), &body).expect("it goes on"), Progressed::Complete);
    }

    #[test]
    fn unknown_task_number_is_rejected() {
        let place = tempfile::tempdir().expect("a folder");
        let folder = TaskFolder::prepare(place.path(), list(3)).expect("room");
        let failure = folder.run_task(3, &body).expect_err("numbered from 0");
        assert!(failure.message().contains("no task 3") && failure.help().is_some(), "{failure}");
        assert!(folder.run_task(2, &body).is_ok());
        let opened = TaskFolder::open(place.path()).expect("of this program");
        assert_eq!(opened.missing(), [0, 1]);
    }

    /// The job script has the tasks that are left, and no more.
    #[test]
    fn script_lists_missing_tasks() {
        let place = tempfile::tempdir().expect("a folder");
        let folder = TaskFolder::prepare(place.path(), list(6)).expect("room");
        folder.run_task(2, &body).expect("room");
        let engine = EngineArguments { slurm: true, ..EngineArguments::default() };
        let Progressed::Scripted(message) = run(&folder, &engine, &body).expect("room") else { panic!("no script") };
        assert!(message.contains("sbatch ") && message.contains("joint again"), "{message}");
        let script = fs::read_to_string(place.path().join("slurm.sh")).expect("written");
        assert!(script.contains("#SBATCH --array=0-1,3-5\n"), "{script}");
        assert_eq!(folder.missing(), [0, 1, 3, 4, 5]);
    }

    #[test]
    fn missing_python_names_remedy() {
        let place = tempfile::tempdir().expect("a folder");
        let failure = dask::run_with("/none/python", "tcp://127.0.0.1:1", place.path(), &Progress::new());
        let failure = failure.expect_err("no such program");
        assert!(failure.message().contains("/none/python"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("pip install")), "{failure}");
    }
}

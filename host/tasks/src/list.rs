//! List of tasks as a file: the program that made it, the texts of all inputs, and the command line of each task.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use report::failure::{Failure, Outcome};
use report::input;

use crate::program;
use report::digest::sha256;

/// Name and version of the format; the version rises when a field changes its meaning or is removed.
const SCHEMA: &str = "joint-tasks/1";
/// Largest number of tasks in a list: SLURM numbers the elements of an array up to 1000 unless `MaxArraySize` is raised.
pub const MAX_TASKS: usize = 1000;

/// Tasks of one command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskList {
    /// `joint-tasks/1`.
    schema: String,
    /// Version and commit of the program that made the list; only this program runs its tasks.
    program: String,
    /// Command that computes the tasks: `sweep` or `hil`.
    kind: String,
    /// Texts of the inputs by their SHA-256.
    inputs: BTreeMap<String, String>,
    /// Tasks by number, from 0.
    tasks: Vec<Task>,
}

/// One task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// SHA-256 over program, kind, inputs and arguments.
    digest: String,
    /// Digests of the inputs, in the order in which the command reads them.
    inputs: Vec<String>,
    /// Command line.
    arguments: Vec<String>,
}

impl TaskList {
    /// Empty list of this program.
    pub fn new(kind: &str) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            program: program::version().to_owned(),
            kind: kind.to_owned(),
            inputs: BTreeMap::new(),
            tasks: Vec::new(),
        }
    }

    /// Adds the text of an input and returns its digest.
    pub fn add_input(&mut self, text: String) -> String {
        let digest = sha256(text.as_bytes());
        self.inputs.insert(digest.clone(), text);
        digest
    }

    /// Adds a task with the digests of its inputs; a task that is in the list already is not added again.
    pub fn add_task(&mut self, inputs: Vec<String>, arguments: Vec<String>) {
        let mut task = Task { digest: String::new(), inputs, arguments };
        task.digest = self.computed_digest(&task);
        if !self.tasks.iter().any(|other| other.digest == task.digest) {
            self.tasks.push(task);
        }
    }

    /// Command that computes the tasks.
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// Tasks by number.
    pub fn tasks(&self) -> &[Task] {
        &self.tasks
    }

    /// Texts of a task's inputs.
    pub fn inputs_of(&self, task: &Task) -> Vec<&str> {
        task.inputs.iter().filter_map(|digest| self.inputs.get(digest)).map(String::as_str).collect()
    }

    /// Reads a list; rejects a damaged one, and the list of another program.
    pub fn read(path: &Path) -> Outcome<Self> {
        let text = input::text(path, input::LARGEST_RECORDED).map_err(|why| {
            Failure::new(format!("cannot read the list of tasks {}: {why}", path.display())).with_help(
                "name the folder `tasks` that `joint sweep`, or `joint hil` with --resume, --dask or --slurm, has made",
            )
        })?;
        let damaged = |why: &str| {
            Failure::new(format!("{} is not a list of tasks: {why}", path.display()))
                .with_help("run the command again that made it: it writes the list anew and keeps the results")
        };
        let list: Self = serde_json::from_str(&text).map_err(|error| damaged(&error.to_string()))?;
        if list.schema != SCHEMA {
            return Err(damaged(&format!("its schema is `{}`, not `{SCHEMA}`", list.schema)));
        }
        if list.program != program::version() {
            let (theirs, ours) = (&list.program, program::version());
            return Err(Failure::new(format!(
                "{} was made by joint {theirs}, and this is joint {ours}",
                path.display()
            ))
            .with_help("install one version on every machine, or run the command again that made the tasks"));
        }
        if list.inputs.iter().any(|(digest, text)| sha256(text.as_bytes()) != *digest) {
            return Err(damaged("an input does not have its digest"));
        }
        if list.tasks.iter().any(|task| list.computed_digest(task) != task.digest) {
            return Err(damaged("a task does not have its digest"));
        }
        if list.tasks.iter().flat_map(|task| &task.inputs).any(|digest| !list.inputs.contains_key(digest)) {
            return Err(damaged("an input is missing"));
        }
        Ok(list)
    }

    /// Text of the file.
    pub(crate) fn text(&self) -> String {
        // A structure of texts can always be written as JSON.
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }

    fn computed_digest(&self, task: &Task) -> String {
        let covered = (&self.schema, &self.program, &self.kind, &task.inputs, &task.arguments);
        sha256(serde_json::to_string(&covered).unwrap_or_default().as_bytes())
    }
}

impl Task {
    /// Digest of the task, the name of its result.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Command line of the task.
    pub fn arguments(&self) -> &[String] {
        &self.arguments
    }

    /// Command line of the task, parsed; its parser has no name of a program.
    pub fn parse<L: clap::Parser>(&self) -> Outcome<L> {
        L::try_parse_from(&self.arguments).map_err(|error| {
            Failure::new(format!("the command line of task {} cannot be read: {error}", self.digest))
                .with_help("run the command again that made the tasks")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str, arguments: &[&str]) -> TaskList {
        let mut list = TaskList::new("sweep");
        let input = list.add_input(text.to_owned());
        list.add_task(vec![input], arguments.iter().map(ToString::to_string).collect());
        list
    }

    #[test]
    fn digest_covers_inputs_and_arguments() {
        let digest = |text, arguments: &[&str]| list(text, arguments).tasks()[0].digest().to_owned();
        let one = digest("a joint", &["--from", "0"]);
        assert_eq!(one, digest("a joint", &["--from", "0"]));
        assert_ne!(one, digest("another", &["--from", "0"]));
        assert_ne!(one, digest("a joint", &["--from", "1"]));
        assert_ne!(one, digest("a joint", &["--from 0"]));
    }

    #[test]
    fn equal_task_is_listed_once() {
        let mut list = list("a joint", &["1"]);
        list.add_task(list.tasks[0].inputs.clone(), vec!["1".to_owned()]);
        assert_eq!(list.tasks().len(), 1);
    }

    /// A list with one changed text, or of another program, is rejected with its remedy.
    #[test]
    fn altered_or_foreign_list_is_rejected() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("list.json");
        let whole = list("a joint", &["1"]).text();
        let refused = |text: &str| {
            std::fs::write(&path, text).expect("room");
            let failure = TaskList::read(&path).expect_err(text);
            assert!(failure.help().is_some(), "{failure}");
            failure.message().to_owned()
        };
        assert!(refused(&whole.replace("a joint", "a joinT")).contains("an input does not have its digest"));
        assert!(refused(&whole.replace("[\"1\"]", "[\"2\"]")).contains("a task does not have its digest"));
        assert!(refused(&whole.replace("tasks/1", "tasks/0")).contains("its schema is `joint-tasks/0`"));
        assert!(refused(&whole.replace(program::version(), "9.9.9")).contains("was made by joint 9.9.9"));
        assert!(refused(&whole[..whole.len() / 2]).contains("is not a list of tasks"));
        std::fs::write(&path, &whole).expect("room");
        assert_eq!(TaskList::read(&path).expect("whole").text(), whole);
    }
}

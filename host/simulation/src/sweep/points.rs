//! Points of a sweep as tasks: each task computes a range of points and has a line for each as its result.

use std::collections::BTreeMap;
use std::ops::Range;

use clap::{Parser, ValueEnum};

use super::grid::Grid;
use super::manifest::Manifest;
use super::metrics::{self, Metric};
use crate::sim::arguments::MotionArguments;
use crate::sim::scheme::{SchemeChoice, SchemeName};
use joint_file::named::{self, Loaded};
use report::digest::sha256;
use report::failure::{Failure, Outcome};
use report::write::write_text;
use tasks::{MAX_TASKS, Task, TaskFolder, TaskList};

/// Kind of a sweep's tasks.
pub const KIND: &str = "sweep";

/// Finished points by number: status and values, as in the result.
pub type Points = BTreeMap<u64, String>;

/// Computation of points.
pub struct Computation<'a> {
    /// Joint file that the grid changes.
    pub base: &'a Loaded,
    /// Grid.
    pub grid: &'a Grid,
    /// Motion of the joint.
    pub motion: &'a MotionArguments,
    /// Scheme.
    pub scheme: SchemeName,
    /// Metrics to compute.
    pub metrics: &'a [Metric],
}

/// Command line of a task.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct Line {
    /// First point.
    #[arg(long)]
    from: u64,
    /// Point after the last one.
    #[arg(long)]
    to: u64,
    /// Motion; a torque profile from a file is the second input.
    #[command(flatten)]
    motion: MotionArguments,
}

/// Tasks of a sweep; `profile` is the text of a torque profile from a file. The ranges depend on the grid only, so that
/// every engine goes on with the results of every other.
pub fn tasks(manifest: &Manifest, motion: &MotionArguments, profile: Option<String>) -> Outcome<TaskList> {
    let mut list = TaskList::new(KIND);
    let mut inputs = vec![list.add_input(manifest.text()?)];
    let from_file = profile.is_some();
    inputs.extend(profile.map(|text| list.add_input(text)));
    let motion = match from_file {
        true => MotionArguments { profile: None, ..motion.clone() },
        false => motion.clone(),
    };
    let size = manifest.points.div_ceil(MAX_TASKS as u64).max(1);
    for from in (0..manifest.points).step_by(size as usize) {
        let to = (from + size).min(manifest.points);
        let range = [format!("--from={from}"), format!("--to={to}")];
        list.add_task(inputs.clone(), range.into_iter().chain(motion.words()).collect());
    }
    Ok(list)
}

impl Computation<'_> {
    /// Computes a task of this sweep.
    pub fn task(&self, task: &Task) -> Outcome<Vec<u8>> {
        let line: Line = task.parse()?;
        self.range(line.from..line.to)
    }

    fn range(&self, range: Range<u64>) -> Outcome<Vec<u8>> {
        let mut lines = String::new();
        for point in range {
            let result = metrics::compute(self.joint(point), self.motion, self.scheme, self.metrics)
                .ok_or_else(|| Failure::interrupted("stopped by the user"))?;
            lines += &format!("{point},{}", result.status);
            result.values.iter().for_each(|value| lines += &format!(",{value}"));
            lines += "\n";
        }
        Ok(lines.into_bytes())
    }

    /// Reason why a point was refused.
    pub fn refusal(&self, point: u64) -> Option<String> {
        metrics::compute(self.joint(point), self.motion, self.scheme, self.metrics)?.remark
    }

    fn joint(&self, point: u64) -> Outcome<Loaded> {
        named::read_changed(self.base.name.clone(), self.base.text.clone(), &self.grid.changes(point))
    }
}

/// Computes a task from its inputs alone, on any machine.
pub fn compute(folder: &TaskFolder, task: &Task) -> Outcome<Vec<u8>> {
    let inputs = folder.list().inputs_of(task);
    let (definition, profile) = (inputs.first().copied().unwrap_or_default(), inputs.get(1));
    let manifest = Manifest::parse(&folder.path().display(), definition)?;
    let Line { from, to, mut motion } = task.parse()?;
    if let Some(text) = profile {
        let path = folder.path().join(format!("profile-{}.csv", sha256(text.as_bytes())));
        if !path.exists() {
            write_text(&path, text)?;
        }
        motion.profile = Some(path.display().to_string());
    }
    let scheme = SchemeChoice::from_str(&manifest.scheme, false).map_err(|_| {
        Failure::new(format!("the scheme `{}` is unknown", manifest.scheme)).with_help("run the sweep again")
    })?;
    let base = named::read_changed(manifest.joint.clone(), manifest.joint_file.clone(), &[])?;
    let grid = manifest.grid()?;
    Computation { base: &base, grid: &grid, motion: &motion, scheme: scheme.shown(), metrics: &manifest.metrics }
        .range(from..to)
}

/// Points of all tasks.
pub fn collect(folder: &TaskFolder) -> Outcome<Points> {
    let mut points = Points::new();
    for task in folder.list().tasks() {
        points.extend(folder.read(task, |bytes| {
            let lines = std::str::from_utf8(bytes).ok()?.lines();
            let parts = |line: &str| line.split_once(',').map(|(point, result)| (point.parse(), result.to_owned()));
            lines
                .map(|line| parts(line).and_then(|(point, result)| Some((point.ok()?, result))))
                .collect::<Option<Points>>()
        })?);
    }
    Ok(points)
}

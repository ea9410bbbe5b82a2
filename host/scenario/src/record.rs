//! The record of tests, as JSON: every figure of every run, every assertion with its verdict, and the command that runs
//! it again. docs/reference/hil-file.md explains the keys, docs/reference/hil-tests.schema.json is their schema.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use report::checks::{Bound, Check, Source, Verdict};
use report::failure::Failure;

/// Name and version of the form.
pub const SCHEMA: &str = "joint-hil-tests/2";

/// All tests of one command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TestsRecord {
    /// Name and version of this form.
    pub schema: String,
    /// Everything that was asked for ran and passed.
    pub passed: bool,
    /// `true` if all seeds of `full_seeds` ran.
    pub full: bool,
    /// Version of the host command.
    pub host_version: String,
    /// Operating system and processor.
    pub host: String,
    /// Commit of the sources, if they were under git; with ` (changed)` if they differ from it.
    pub git_commit: Option<String>,
    /// Start, ISO 8601 with time zone.
    pub date: String,
    /// Time on the clock [s].
    pub seconds: f64,
    /// The tests, in the order in which they ran.
    pub tests: Vec<TestRecord>,
    /// Files that were asked for and could not run.
    pub not_run: Vec<NotRun>,
}

/// A test file that could not run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct NotRun {
    /// Path as the user named it.
    pub file: String,
    /// Reason why the file could not run.
    pub why: String,
    /// Remedy.
    #[serde(rename = "mend")]
    pub remedy: Option<String>,
}

impl NotRun {
    /// Record of a failure.
    pub fn new(file: String, failure: &Failure) -> Self {
        let message = failure.message();
        let why = message.strip_prefix(&file).map_or(message, |rest| rest.trim_start_matches([':', ' ']));
        Self { why: why.to_owned(), remedy: failure.full_help(), file }
    }
}

/// One test file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TestRecord {
    /// Path as the user named it.
    pub file: String,
    /// SHA-256 of the file's text.
    pub file_sha256: String,
    /// Title of the test.
    pub title: String,
    /// Name of the joint.
    pub joint: String,
    /// SHA-256 of the joint file's text, before any change.
    pub joint_sha256: String,
    /// Place of the tested controller: `host`, or role and board; rivals always run on the host.
    pub on: String,
    /// Plant: `reference` or `core`.
    pub plant: String,
    /// Kind of the motion.
    pub profile: String,
    /// Name of the controller.
    pub controller: String,
    /// Bandwidth of the tested compensation; absent where another controller is tested.
    pub bandwidth: Option<BandwidthRecord>,
    /// Length of a run [s].
    pub duration_s: f64,
    /// Start of the figures [s].
    pub settle_s: f64,
    /// Faults by their words.
    pub faults: Vec<String>,
    /// Seeds that ran.
    pub seeds: Vec<u64>,
    /// `true` if every assertion held.
    pub passed: bool,
    /// Reason why the test broke off, if it did.
    pub broken: Option<String>,
    /// Assertions with their verdicts.
    pub assertions: Vec<AssertionRecord>,
    /// Runs of every seed and controller.
    pub runs: Vec<TestRun>,
    /// The seed that the report shows.
    pub shown_seed: u64,
    /// Command line that runs this test again.
    pub replay: String,
    /// Time on the clock [s].
    pub seconds: f64,
}

/// Bandwidth of a compensation in the shown seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BandwidthRecord {
    /// Bandwidth that the controllers have [rad/s].
    pub used_rad_per_s: f64,
    /// `true` if the test file asks for it; otherwise it follows from the joint.
    pub asked: bool,
    /// Widest bandwidth that the joint allows [rad/s].
    pub widest_rad_per_s: f64,
    /// Reason for the widest bandwidth.
    pub limited_by: String,
}

impl BandwidthRecord {
    /// Bandwidth as text.
    pub fn in_words(&self) -> String {
        let asked = if self.asked { " asked" } else { "" };
        format!("{} rad/s{asked}, {} at most: {}", self.used_rad_per_s, self.widest_rad_per_s, self.limited_by)
    }
}

/// One bound on one figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AssertionRecord {
    /// Name of the figure.
    pub name: String,
    /// Aggregate over the seeds: `worst`, `median`, `mean`, or the worst of `all but` a share of them.
    pub aggregate: String,
    /// Value of the figure; absent if not available.
    pub figure: Option<f64>,
    /// Unit of figure and bound.
    pub unit: String,
    /// Bound of the figure.
    pub bound: Bound,
    /// Verdict of the assertion.
    pub verdict: Verdict,
    /// Seed that is farthest on the wrong side of the bound.
    pub seed: Option<u64>,
    /// Meaning of the figure, range over the seeds, and seeds beyond the bound.
    pub note: String,
}

/// One controller in one seed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TestRun {
    /// The seed.
    pub seed: u64,
    /// Name of the controller.
    pub controller: String,
    /// Digest over every bit of the run, 16 hexadecimal digits.
    pub digest: String,
    /// Values that the seed drew, by key; empty if the file draws none.
    #[serde(default)]
    pub drawn: BTreeMap<String, f64>,
    /// The MCAP log, beside the report.
    pub log: Option<String>,
    /// Memory file with the estimated parameters at the end, beside the log, if `--memory` was given.
    pub memory: Option<String>,
    /// Reason of an early end, if any.
    pub broken: Option<String>,
    /// Reason why the width probe refused to publish a width, if it did.
    pub refusal: Option<String>,
    /// Figures by name.
    pub figures: BTreeMap<String, f64>,
    /// Board of the run, if it ran on a board.
    pub board: Option<BoardRun>,
}

/// A run on a board.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BoardRun {
    /// `observer` or `loop`.
    pub role: String,
    /// SHA-256 of the board's image.
    pub elf_sha256: String,
    /// Control periods that are equal in every bit on board and host.
    pub same_periods: u32,
    /// Computation of a tick in timer counts, mean.
    pub computation_mean: u32,
    /// Computation of a tick in timer counts, largest.
    pub computation_most: u32,
    /// Timer counts in a control period.
    pub period_counts: u32,
    /// Ticks that took longer than their period.
    pub overruns: u32,
    /// Deepest stack [byte].
    pub stack_bytes: u32,
}

impl AssertionRecord {
    /// Assertion as a line of a table of checks.
    pub fn check(&self) -> Check {
        let name = match self.aggregate.as_str() {
            "worst" => self.name.clone(),
            aggregate => format!("{} ({aggregate})", self.name),
        };
        Check {
            name,
            figure: self.figure,
            unit: self.unit.clone(),
            bound: self.bound,
            verdict: self.verdict,
            source: Source::Host,
            note: self.note.clone(),
        }
    }
}

impl TestRecord {
    /// Assertions that did not hold.
    pub fn failed(&self) -> impl Iterator<Item = &AssertionRecord> {
        self.assertions.iter().filter(|assertion| assertion.verdict == Verdict::Failed)
    }

    /// Largest value of a controller's figure over all seeds.
    pub fn largest(&self, controller: &str, figure: &str) -> Option<f64> {
        let runs = self.runs.iter().filter(|run| run.controller == controller);
        runs.filter_map(|run| run.figures.get(figure).copied()).reduce(f64::max)
    }

    /// Controllers that ran, the tested one first.
    pub fn controllers(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for run in &self.runs {
            if !names.contains(&run.controller.as_str()) {
                names.push(&run.controller);
            }
        }
        names
    }
}

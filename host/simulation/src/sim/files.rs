//! Files of a run. The history grows under a temporary name and takes its final name when it is complete, so an older
//! history is replaced by a complete one or not at all.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::PathBuf;

use parameters::JointParameters;

use super::csv;
use super::log_file::{self, SCHEMA_NAME, TOPIC, message};
use super::snapshot::Snapshot;
use report::failure::{Failure, Outcome};
use report::folder::Folder;
use report::log::Channel;
use report::write::write_failure;

/// Page.
pub const REPORT: &str = "report.html";
/// Figures as JSON.
pub const FIGURES: &str = "figures.json";
/// Temporary and final names.
const CSV_NAMES: [&str; 2] = ["history.partial.csv", "history.csv"];
const LOG_NAMES: [&str; 2] = ["history.partial.mcap", "history.mcap"];
/// All files that a run writes.
pub const RUN_FILES: [&str; 6] = [REPORT, FIGURES, CSV_NAMES[0], CSV_NAMES[1], LOG_NAMES[0], LOG_NAMES[1]];

/// Growing CSV and log of one run.
pub struct HistoryFiles<'a> {
    folder: &'a Folder,
    joint: &'a JointParameters,
    csv: BufWriter<File>,
    log: Channel<BufWriter<File>>,
}

impl<'a> HistoryFiles<'a> {
    /// Starts both files.
    pub fn begin(folder: &'a Folder, joint: &'a JointParameters, remarks: BTreeMap<String, String>) -> Outcome<Self> {
        let both = || {
            let mut csv = BufWriter::new(folder.grow(CSV_NAMES[0])?);
            csv::write_head(&mut csv, joint.geometry.planets)
                .map_err(|error| write_failure(&folder.file(CSV_NAMES[0]), &error))?;
            let log = BufWriter::new(folder.grow(LOG_NAMES[0])?);
            let log = Channel::begin(log, TOPIC, SCHEMA_NAME, &log_file::schema(joint.geometry.planets), remarks)
                .map_err(|error| write_failure(&folder.file(LOG_NAMES[0]), &error))?;
            Ok(Self { folder, joint, csv, log })
        };
        both().map_err(|failure| with_partial_files(folder, failure))
    }

    /// Writes one sample.
    pub fn write(&mut self, snapshot: &Snapshot) -> Outcome<()> {
        csv::write_row(&mut self.csv, self.joint, snapshot)
            .map_err(|error| write_failure(&self.folder.file(CSV_NAMES[0]), &error))?;
        self.log
            .write(snapshot.time, &message(self.joint, snapshot))
            .map_err(|error| write_failure(&self.folder.file(LOG_NAMES[0]), &error))
    }

    /// Finishes both files. A complete history takes its final name; an interrupted one keeps the temporary name.
    pub fn finish(self, whole: bool) -> Outcome<[PathBuf; 2]> {
        let Self { folder, csv, log, .. } = self;
        let keep = |file: io::Result<BufWriter<File>>, [growing, whole_name]: [&str; 2]| {
            let ended = file.and_then(|file| {
                // A full disk may only show when the data leave the cache.
                file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
            });
            ended.map_err(|error| write_failure(&folder.file(growing), &error))?;
            folder.keep(growing, if whole { whole_name } else { growing })
        };
        // Both are finished, even if the first one fails.
        let (csv, log) = (keep(Ok(csv), CSV_NAMES), keep(log.finish(), LOG_NAMES));
        csv.and_then(|csv| Ok([csv, log?])).map_err(|failure| with_partial_files(folder, failure))
    }

    /// Finishes both files after a failure of the run, and adds their paths to the failure.
    pub fn finish_after(self, failure: Failure) -> Failure {
        let folder = self.folder;
        // A failure of the run is more informative than one of its files.
        let _ = self.finish(false);
        with_partial_files(folder, failure)
    }
}

/// Adds the paths of the partial files to a failure; empty files are removed.
fn with_partial_files(folder: &Folder, failure: Failure) -> Failure {
    let mut kept = Vec::new();
    for path in [CSV_NAMES, LOG_NAMES].map(|[growing, _]| folder.file(growing)) {
        match fs::metadata(&path) {
            Ok(data) if data.len() > 0 => kept.push(path.display().to_string()),
            // An empty file of this run may stay if it cannot be removed.
            Ok(_) => drop(fs::remove_file(&path)),
            Err(_) => {}
        }
    }
    if kept.is_empty() {
        return failure;
    }
    let kept = format!("the samples written so far are in {}", kept.join(" and "));
    let help = failure.help().map_or_else(|| kept.clone(), |help| format!("{help}\n{kept}"));
    failure.with_help(help)
}

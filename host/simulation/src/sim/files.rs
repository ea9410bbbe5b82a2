//! What a run leaves on disk. The history grows under a name of its own while the run goes on and takes its final name
//! when it is whole, so that an older history is replaced by a whole one or not at all.

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
use report::write::unwritten;

/// The page.
pub const REPORT: &str = "report.html";
/// The figures of the console.
pub const FIGURES: &str = "figures.json";
/// Growing and final name.
const CSV: [&str; 2] = ["history.partial.csv", "history.csv"];
const LOG: [&str; 2] = ["history.partial.mcap", "history.mcap"];
/// Everything that a run writes.
pub const ALL: [&str; 6] = [REPORT, FIGURES, CSV[0], CSV[1], LOG[0], LOG[1]];

/// CSV and log of one run, growing.
pub struct HistoryFiles<'a> {
    folder: &'a Folder,
    joint: &'a JointParameters,
    csv: BufWriter<File>,
    log: Channel<BufWriter<File>>,
}

impl<'a> HistoryFiles<'a> {
    /// Begins both.
    pub fn begin(folder: &'a Folder, joint: &'a JointParameters, remarks: BTreeMap<String, String>) -> Outcome<Self> {
        let both = || {
            let mut csv = BufWriter::new(folder.grow(CSV[0])?);
            csv::write_head(&mut csv, joint.geometry.planets)
                .map_err(|error| unwritten(&folder.file(CSV[0]), &error))?;
            let log = BufWriter::new(folder.grow(LOG[0])?);
            let log = Channel::begin(log, TOPIC, SCHEMA_NAME, &log_file::schema(joint.geometry.planets), remarks)
                .map_err(|error| unwritten(&folder.file(LOG[0]), &error))?;
            Ok(Self { folder, joint, csv, log })
        };
        both().map_err(|failure| left(folder, failure))
    }

    /// One sample.
    pub fn write(&mut self, snapshot: &Snapshot) -> Outcome<()> {
        csv::write_row(&mut self.csv, self.joint, snapshot)
            .map_err(|error| unwritten(&self.folder.file(CSV[0]), &error))?;
        self.log
            .write(snapshot.time, &message(self.joint, snapshot))
            .map_err(|error| unwritten(&self.folder.file(LOG[0]), &error))
    }

    /// Ends both properly. A whole history takes its final name; one that was cut short keeps the growing one.
    pub fn finish(self, whole: bool) -> Outcome<[PathBuf; 2]> {
        let Self { folder, csv, log, .. } = self;
        let keep = |file: io::Result<BufWriter<File>>, [growing, whole_name]: [&str; 2]| {
            let ended = file.and_then(|file| {
                // A full disk may only be noticed when the data leave the cache.
                file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
            });
            ended.map_err(|error| unwritten(&folder.file(growing), &error))?;
            folder.keep(growing, if whole { whole_name } else { growing })
        };
        // Both are ended, whatever becomes of the first.
        let (csv, log) = (keep(Ok(csv), CSV), keep(log.finish(), LOG));
        csv.and_then(|csv| Ok([csv, log?])).map_err(|failure| left(folder, failure))
    }

    /// A failure of the run, with what is left of its history, which is ended as well as it can be.
    pub fn told(self, failure: Failure) -> Failure {
        let folder = self.folder;
        // The failure of the run says more than one of its files.
        let _ = self.finish(false);
        left(folder, failure)
    }
}

/// A failure with the help of where what was written until then is. Where nothing could be written no file is left behind.
fn left(folder: &Folder, failure: Failure) -> Failure {
    let mut kept = Vec::new();
    for path in [CSV, LOG].map(|[growing, _]| folder.file(growing)) {
        match fs::metadata(&path) {
            Ok(data) if data.len() > 0 => kept.push(path.display().to_string()),
            // It was ours, and it was empty: nothing is lost if it stays.
            Ok(_) => drop(fs::remove_file(&path)),
            Err(_) => {}
        }
    }
    if kept.is_empty() {
        return failure;
    }
    let kept = format!("what was written until then is in {}", kept.join(" and "));
    let help = failure.help().map_or_else(|| kept.clone(), |help| format!("{help}\n{kept}"));
    failure.with_help(help)
}

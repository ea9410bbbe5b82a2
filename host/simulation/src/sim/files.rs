//! What a run leaves on disk. The history grows under a name of its own while the run goes on and takes its final name
//! when it is whole, so that an older history is replaced by a whole one or not at all.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::PathBuf;

use parameters::JointParameters;

use super::csv;
use super::log_file::{self, Channel, SCHEMA_NAME, TOPIC, encoded};
use super::snapshot::Snapshot;
use report::failure::Outcome;
use report::folder::Folder;
use report::write::unwritten;

/// CSV and log of one run, growing.
pub struct HistoryFiles<'a> {
    folder: &'a Folder,
    joint: &'a JointParameters,
    csv: BufWriter<File>,
    log: Channel<BufWriter<File>>,
}

/// Growing and final name.
const CSV: [&str; 2] = ["history.partial.csv", "history.csv"];
const LOG: [&str; 2] = ["history.partial.mcap", "history.mcap"];

impl<'a> HistoryFiles<'a> {
    /// Begins both.
    pub fn begin(folder: &'a Folder, joint: &'a JointParameters, remarks: BTreeMap<String, String>) -> Outcome<Self> {
        let create = |name: &str| {
            let path = folder.file(name);
            File::create(&path).map(BufWriter::new).map_err(|error| unwritten(&path, &error))
        };
        let both = || {
            let mut csv = create(CSV[0])?;
            csv::write_head(&mut csv, joint.geometry.planets)
                .map_err(|error| unwritten(&folder.file(CSV[0]), &error))?;
            let log = Channel::begin(create(LOG[0])?, TOPIC, SCHEMA_NAME, &log_file::schema(), remarks)
                .map_err(|error| unwritten(&folder.file(LOG[0]), &error))?;
            Ok(Self { folder, joint, csv, log })
        };
        both().inspect_err(|_| remove_empty(folder))
    }

    /// One sample.
    pub fn write(&mut self, snapshot: &Snapshot) -> Outcome<()> {
        csv::write_row(&mut self.csv, self.joint, snapshot)
            .map_err(|error| unwritten(&self.folder.file(CSV[0]), &error))?;
        self.log
            .write(snapshot.time, &encoded(self.joint, snapshot))
            .map_err(|error| unwritten(&self.folder.file(LOG[0]), &error))
    }

    /// Ends both properly. A whole history takes its final name; one that was cut short keeps the growing one.
    pub fn finish(self, whole: bool) -> Outcome<[PathBuf; 2]> {
        let Self { folder, csv, log, .. } = self;
        let keep = |file: io::Result<BufWriter<File>>, [growing, whole_name]: [&str; 2]| {
            let path = folder.file(growing);
            let kept = file.and_then(|file| {
                // A full disk may only be noticed when the data leave the cache.
                file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
                let name = folder.file(if whole { whole_name } else { growing });
                fs::rename(&path, &name).map(|()| name)
            });
            kept.map_err(|error| unwritten(&path, &error))
        };
        // Both are ended, whatever becomes of the first.
        let (csv, log) = (keep(Ok(csv), CSV), keep(log.finish(), LOG));
        csv.and_then(|csv| Ok([csv, log?])).inspect_err(|_| remove_empty(folder))
    }
}

/// Where nothing could be written no file is left behind either.
fn remove_empty(folder: &Folder) {
    for path in [CSV, LOG].map(|[growing, _]| folder.file(growing)) {
        if fs::metadata(&path).is_ok_and(|data| data.len() == 0) {
            // It was ours, and it was empty: nothing is lost if it stays.
            let _ = fs::remove_file(&path);
        }
    }
}

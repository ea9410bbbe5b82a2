//! The files of a run: report, record and log in one folder. If the disk is full after a run, the record is written to
//! the system's temporary folder instead.

use std::fs;
use std::path::{Path, PathBuf};

use crate::record::RunRecord;
use crate::{log_file, page};
use board::logs;
use report::failure::{Failure, Outcome};
use report::folder::Folder;
use report::output;

const REPORT: &str = "report.html";
const RECORD: &str = "record.json";
const LOG: &str = "log.txt";
const SAMPLES: &str = "run.mcap";
/// Everything that a run writes.
pub const ALL: [&str; 4] = [REPORT, RECORD, LOG, SAMPLES];

/// Writes everything, the record also to a file that was asked for by name; returns where the report is.
pub fn write(folder: &Folder, json: Option<&Path>, record: &RunRecord) -> Outcome<PathBuf> {
    let kept = write_to(folder, record);
    let asked = json.map_or(Ok(()), |json| output::write_json_record(json, record));
    match (kept, asked) {
        (Ok(report), Ok(())) => Ok(report),
        (Ok(_), Err(failure)) => Err(failure.with_help(format!("the record is in {}", folder.file(RECORD).display()))),
        (Err(failure), _) => Err(elsewhere(failure, record)),
    }
}

/// A second place for what cannot be measured again.
fn elsewhere(failure: Failure, record: &RunRecord) -> Failure {
    let folder = std::env::temp_dir().join(format!("joint-hil-{}", std::process::id()));
    // Made here and now, or it may be anybody's and is not taken away again.
    let new = fs::create_dir(&folder).is_ok();
    let written = Folder::prepare(Some(&folder), "hil", "", &ALL).and_then(|folder| write_to(&folder, record));
    let help = if written.is_ok() || folder.join(RECORD).exists() {
        format!("what was recorded is in {}; for the next run name another folder by --out DIR", folder.display())
    } else {
        if new {
            // Nothing of use is in it; if it stays it is no harm.
            let _ = fs::remove_dir_all(&folder);
        }
        "free some space, or name another folder by --out DIR, and run again".to_owned()
    };
    failure.with_help(help)
}

/// Writes everything to a folder. The record, which holds everything, is there first; a report that cannot be written must
/// not cost it, nor the other way round.
pub fn write_to(folder: &Folder, record: &RunRecord) -> Outcome<PathBuf> {
    folder.write_text(LOG, &logs::text(&record.log))?;
    let kept = folder.write_record(RECORD, record);
    let shown = folder.write_text(REPORT, &page::render(record));
    let logged = folder.write_with(SAMPLES, |file| log_file::fill(file, record));
    kept.and(shown).and(logged)?;
    Ok(folder.file(REPORT))
}

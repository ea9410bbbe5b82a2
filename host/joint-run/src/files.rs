//! Files of a run: report, record and log in one folder. If the disk is full after a run, the record goes to the
//! system's temporary folder instead.

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
/// Names of all files of a run.
pub const ALL_FILES: [&str; 4] = [REPORT, RECORD, LOG, SAMPLES];

/// Writes all files, and the record to a named file if requested; returns the path of the report.
pub fn write(folder: &Folder, json: Option<&Path>, record: &RunRecord) -> Outcome<PathBuf> {
    let kept = write_to(folder, record);
    let asked = json.map_or(Ok(()), |json| output::write_json_record(json, record));
    match (kept, asked) {
        (Ok(report), Ok(())) => Ok(report),
        (Ok(_), Err(failure)) => Err(failure.with_help(format!("the record is in {}", folder.file(RECORD).display()))),
        (Err(failure), _) => Err(write_to_temporary(failure, record)),
    }
}

/// Writes the record, which cannot be measured again, to the temporary folder.
fn write_to_temporary(failure: Failure, record: &RunRecord) -> Failure {
    let folder = std::env::temp_dir().join(format!("joint-hil-{}", std::process::id()));
    // Only a folder created here is removed again.
    let new = fs::create_dir(&folder).is_ok();
    let written = Folder::prepare(Some(&folder), "hil", "", &ALL_FILES).and_then(|folder| write_to(&folder, record));
    let help = if written.is_ok() || folder.join(RECORD).exists() {
        format!("the recording is in {}; for the next run name another folder with --out DIR", folder.display())
    } else {
        if new {
            // The folder is useless; a leftover does no harm.
            let _ = fs::remove_dir_all(&folder);
        }
        "free some space, or name another folder with --out DIR, and run again".to_owned()
    };
    failure.with_help(help)
}

/// Writes all files to a folder, first the record with all data. A failure of the report or the log does not affect the
/// record, nor the reverse.
pub fn write_to(folder: &Folder, record: &RunRecord) -> Outcome<PathBuf> {
    folder.write_text(LOG, &logs::text(&record.log))?;
    let kept = folder.write_record(RECORD, record);
    let shown = folder.write_text(REPORT, &page::render(record));
    let logged = folder.write_with(SAMPLES, |file| log_file::write(file, record));
    kept.and(shown).and(logged)?;
    Ok(folder.file(REPORT))
}

//! The files of a run: report, record and log in one folder. If the disk is full after a run, the record is written to
//! the system's temporary folder instead.

use std::fs;
use std::path::{Path, PathBuf};

use crate::page;
use crate::record::RunRecord;
use board::logs;
use report::failure::{Failure, Outcome};
use report::folder::Folder;
use report::write::{write_record, write_text};

/// Writes everything, the record also to a file that was asked for by name; returns where the report is.
pub fn write(folder: &Folder, json: Option<&Path>, record: &RunRecord) -> Outcome<PathBuf> {
    let kept = write_to(folder.path(), record);
    let asked = json.map_or(Ok(()), |json| write_record(json, record));
    match (kept, asked) {
        (Ok(report), Ok(())) => Ok(report),
        (Ok(_), Err(failure)) => {
            Err(failure.with_help(format!("the record is in {}", folder.file("record.json").display())))
        }
        (Err(failure), _) => Err(elsewhere(failure, record)),
    }
}

/// A second place for what cannot be measured again.
fn elsewhere(failure: Failure, record: &RunRecord) -> Failure {
    let folder = std::env::temp_dir().join(format!("joint-hil-{}", std::process::id()));
    let written = fs::create_dir_all(&folder).is_ok() && write_to(&folder, record).is_ok();
    let help = match written {
        true => {
            format!("what was recorded is in {}; for the next run name another folder by --out DIR", folder.display())
        }
        false => "free some space, or name another folder by --out DIR, and run again".to_owned(),
    };
    failure.with_help(help)
}

fn write_to(folder: &Path, record: &RunRecord) -> Outcome<PathBuf> {
    let html = folder.join("report.html");
    write_text(&folder.join("log.txt"), &logs::text(&record.log))?;
    page::write(record, Some(&folder.join("record.json")), Some(&html))?;
    Ok(html)
}

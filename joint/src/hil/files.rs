//! What a run leaves on disk: report, record and log in one folder. A folder that cannot be written is found before the
//! run; if the disk is full after it, what was recorded goes elsewhere rather than nowhere.

use std::fs;
use std::path::{Path, PathBuf};

use super::logs;
use crate::failure::{Failure, Outcome};
use crate::record::{RunRecord, write_text};
use crate::report;
use crate::target::toolchain::workspace;

/// Where a run's files go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    folder: PathBuf,
    json: Option<PathBuf>,
}

impl Files {
    /// Makes the folder and tries to write to it.
    pub fn prepare(folder: Option<&Path>, json: Option<&Path>, joint: &str) -> Outcome<Self> {
        let folder = folder.map_or_else(|| workspace().join("target/hil").join(plain(joint)), Path::to_owned);
        fs::create_dir_all(&folder).map_err(|error| {
            Failure::new(format!("cannot make the folder {} for the report: {error}", folder.display()))
                .with_help("name a folder that can be written by --out DIR")
        })?;
        let probe = folder.join(".can-be-written");
        write_text(&probe, "")?;
        // It was ours, and it was empty: nothing is lost if it stays.
        let _ = fs::remove_file(&probe);
        if let Some(parent) =
            json.and_then(Path::parent).filter(|parent| !parent.as_os_str().is_empty() && !parent.is_dir())
        {
            return Err(Failure::new(format!("there is no folder {} for --json", parent.display())));
        }
        Ok(Self { folder, json: json.map(Path::to_owned) })
    }

    /// Writes everything; returns where the report is.
    pub fn write(&self, record: &RunRecord) -> Outcome<PathBuf> {
        let kept = write_to(&self.folder, record);
        let asked = self.json.as_ref().map_or(Ok(()), |json| record.write_json(json));
        match (kept, asked) {
            (Ok(report), Ok(())) => Ok(report),
            (Ok(_), Err(failure)) => {
                Err(failure.with_help(format!("the record is in {}", self.folder.join("record.json").display())))
            }
            (Err(failure), _) => Err(elsewhere(failure, record)),
        }
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
    report::write(record, Some(&folder.join("record.json")), Some(&html))?;
    Ok(html)
}

/// A joint's name as the name of a folder.
fn plain(joint: &str) -> String {
    joint.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(folder: &str) -> Failure {
        Files::prepare(Some(Path::new(folder)), None, "Q1").expect_err("cannot be written")
    }

    #[test]
    fn a_folder_that_cannot_be_is_found_before_the_run() {
        for folder in ["/dev/full/x", "/proc/x", "/dev/null"] {
            let failure = refused(folder);
            assert!(failure.message().contains(folder), "{failure}");
            assert!(failure.help().is_some(), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    #[test]
    fn a_json_file_in_no_folder_is_found_before_the_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let json = folder.path().join("none/out.json");
        assert!(Files::prepare(Some(folder.path()), Some(&json), "Q1").is_err());
        assert!(Files::prepare(Some(folder.path()), Some(Path::new("out.json")), "Q1").is_ok());
    }

    #[test]
    fn a_joints_name_makes_a_folder() {
        assert_eq!(plain("Q1 (b 0.5)"), "q1--b-0-5-");
    }
}

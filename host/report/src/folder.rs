//! The folder that a command writes its results to, and the files that the user named. Paths that cannot be written are
//! reported before the work begins.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::document::is_own_page;
use crate::failure::{Failure, Outcome};
use crate::workspace::workspace;
use crate::write::write_text;

/// What every such folder gets.
const REPORT: &str = "report.html";

/// Where the files of a run go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder and tries to write to it. Where none is wanted it is `target/KIND/JOINT`.
    pub fn prepare(wanted: Option<&Path>, kind: &str, joint: &str) -> Outcome<Self> {
        let usual = || workspace().join("target").join(kind).join(file_part(joint));
        let path = wanted.map_or_else(usual, Path::to_owned);
        make(&path)?;
        if wanted.is_some() {
            refuse_foreign(&path)?;
        }
        let probe = path.join(".can-be-written");
        write_text(&probe, "")?;
        // It was ours, and it was empty: nothing is lost if it stays.
        let _ = fs::remove_file(&probe);
        Ok(Self { path })
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Refuses a folder whose report somebody else has written: a second one would be the loss of that.
fn refuse_foreign(folder: &Path) -> Outcome<()> {
    let report = folder.join(REPORT);
    match is_own_page(&report) {
        Ok(true) => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        _ => Err(Failure::new(format!("{} was not written by this command and would be lost", report.display()))
            .with_help("name another folder by --out DIR, or move this file elsewhere; it is left as it is")),
    }
}

/// Makes a folder that `--out` names.
pub fn make(folder: &Path) -> Outcome<()> {
    fs::create_dir_all(folder).map_err(|error| {
        Failure::new(format!("cannot make the folder {}: {error}", folder.display()))
            .with_help("name a folder that can be written by --out DIR")
    })
}

/// Refuses a file for an option that cannot be one, or that the command itself reads: writing it would be the loss of that.
pub fn check_file(option: &str, file: &Path, read: &[&Path]) -> Outcome<()> {
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    if let Some(parent) = parent.filter(|parent| !parent.is_dir()) {
        return Err(Failure::new(format!("there is no folder {} for --{option}", parent.display()))
            .with_help("create it first, or name another file"));
    }
    if file.is_dir() {
        return Err(Failure::new(format!("--{option} {} is a folder", file.display())).with_help("name a file in it"));
    }
    let whole = file.canonicalize();
    let same = |read: &&&Path| whole.as_ref().is_ok_and(|whole| read.canonicalize().is_ok_and(|read| *whole == read));
    if let Some(read) = read.iter().find(same) {
        let message =
            format!("--{option} {} would write over {}, which this command reads", file.display(), read.display());
        return Err(Failure::new(message).with_help("name another file"));
    }
    Ok(())
}

/// The same for what several options ask for, no two of which may be one file. "-" is standard output.
pub fn check_files(wanted: &[(&str, Option<&Path>)], read: &[&Path]) -> Outcome<()> {
    let files = wanted.iter().filter_map(|(option, file)| Some((*option, (*file)?)));
    let files: Vec<(&str, &Path)> = files.filter(|(_, file)| file.as_os_str() != "-").collect();
    for (place, (option, file)) in files.iter().enumerate() {
        check_file(option, file, read)?;
        if let Some((other, _)) = files[..place].iter().find(|(_, before)| before == file) {
            return Err(Failure::new(format!("--{other} and --{option} both name {}", file.display()))
                .with_help("name a file for each"));
        }
    }
    Ok(())
}

/// A joint's name, or a number, as part of the name of a file or folder.
pub fn file_part(joint: &str) -> String {
    joint.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_cannot_be_is_found_before_the_run() {
        for folder in ["/dev/full/x", "/proc/x", "/dev/null"] {
            let failure = Folder::prepare(Some(Path::new(folder)), "hil", "Q1").expect_err("cannot be written");
            assert!(failure.message().contains(folder), "{failure}");
            assert!(failure.help().is_some(), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    #[test]
    fn a_report_that_somebody_else_has_written_is_not_written_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let prepare = || Folder::prepare(Some(folder.path()), "sim", "Q1");
        let report = prepare().expect("an empty folder").file(REPORT);
        fs::write(&report, "<!DOCTYPE html><title>my thesis</title>").expect("room");
        let failure = prepare().expect_err("a foreign report");
        assert!(failure.message().contains("report.html was not written by this command"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("--out DIR")), "{failure}");
        fs::write(&report, crate::document::html(&crate::document::Document::default())).expect("room");
        assert!(prepare().is_ok(), "a report of ours is replaced by the next one");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_found_before_the_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let refused = |file: &Path| check_file("json", file, &[]).expect_err("no file").message().contains("--json");
        assert!(refused(&folder.path().join("none/out.json")) && refused(folder.path()));
        assert!(check_file("json", Path::new("out.json"), &[]).is_ok());
    }

    #[test]
    fn what_is_read_is_not_written_over_whatever_it_is_called() {
        let folder = tempfile::tempdir().expect("a folder");
        let input = folder.path().join("in.toml");
        fs::write(&input, "").expect("a file");
        let alias = folder.path().join("../").join(folder.path().file_name().expect("a name")).join("in.toml");
        for output in [&input, &alias] {
            let failure = check_file("json", output, &[&input]).expect_err("the same file");
            assert!(failure.message().contains("which this command reads") && failure.help().is_some(), "{failure}");
        }
        assert!(check_file("json", &folder.path().join("out.json"), &[&input]).is_ok());
    }

    #[test]
    fn two_options_do_not_share_a_file() {
        let [one, other] = ["a.json", "b.xml"].map(|name| Some(Path::new(name)));
        assert!(check_files(&[("json", one), ("junit", other)], &[]).is_ok());
        let failure = check_files(&[("json", one), ("junit", one)], &[]).expect_err("the same file");
        assert!(failure.message().contains("--json and --junit"), "{failure}");
        let out = Some(Path::new("-"));
        assert!(check_files(&[("json", out), ("html", other)], &[]).is_ok());
    }

    #[test]
    fn a_joints_name_makes_a_folder() {
        assert_eq!(file_part("Q1 (b 0.5)"), "q1--b-0-5-");
    }
}

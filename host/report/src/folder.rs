//! Output folder of a command, and output files that the user named. Unwritable paths are reported before the work
//! begins.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::interruption::UninterruptedWork;
use crate::own_files::{OwnFiles, Owner, Writers};
use crate::write::{is_standard_output, record_into, write_failure, write_with};

/// Default folder of results, below the working folder.
const RESULTS_FOLDER: &str = "joint-out";

/// Default folder of results of a kind, such as those of a command for a joint.
pub fn default_folder(kind: &str, name: &str) -> PathBuf {
    Path::new(RESULTS_FOLDER).join(kind).join(file_part(name))
}

/// Output folder of a run.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    files: &'static [&'static str],
    own: OwnFiles,
}

impl Folder {
    /// Chooses the folder for `files`, each name with at most one `*`; the default is [`default_folder`]. Rejects a folder in
    /// which one of these files was not written by a command, since it would be lost. Writes nothing.
    pub fn choose(wanted: Option<&Path>, kind: &str, joint: &str, files: &'static [&'static str]) -> Outcome<Self> {
        let path = wanted.map_or_else(|| default_folder(kind, joint), Path::to_owned);
        let folder = Self { own: OwnFiles::read(&path)?, path, files };
        folder.refuse_foreign()?;
        Ok(folder)
    }

    /// Chooses the folder, creates it and makes it ready for writing.
    pub fn prepare(wanted: Option<&Path>, kind: &str, joint: &str, files: &'static [&'static str]) -> Outcome<Self> {
        let folder = Self::choose(wanted, kind, joint, files)?;
        folder.make()?;
        Ok(folder)
    }

    /// Prepares a folder for one of several runs that have files of their own and all write the given files at their
    /// end.
    pub fn prepare_beside_others(
        path: &Path,
        kind: &str,
        joint: &str,
        files: &'static [&'static str],
    ) -> Outcome<Self> {
        let folder = Self::choose(Some(path), kind, joint, files)?;
        make(&folder.path)?;
        folder.own.open(Writers::Several)?;
        Ok(folder)
    }

    /// Creates the folder and tests writing. Rejects a folder that another run writes to.
    pub fn make(&self) -> Outcome<()> {
        make(&self.path)?;
        self.own.open(Writers::One)?;
        // Another run may have ended since the folder was chosen.
        self.refuse_foreign()
    }

    /// Path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file, completely or not at all.
    pub fn write_text(&self, name: &str, text: &str) -> Outcome<()> {
        self.write_with(name, |file| file.write_all(text.as_bytes()))
    }

    /// Writes a record as JSON in one line, completely or not at all.
    pub fn write_record(&self, name: &str, record: &impl Serialize) -> Outcome<()> {
        self.write_with(name, |file| record_into(file, record))
    }

    /// Fills a file, completely or not at all.
    pub fn write_with(&self, name: &str, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Outcome<()> {
        debug_assert!(self.is_announced(name), "{name} was not looked for before the run");
        write_with(&self.file(name), |ready| self.own.claim(name, ready), fill)
    }

    /// Creates a file that grows during a run. It counts as the command's own even if incomplete.
    pub fn grow(&self, name: &str) -> Outcome<File> {
        debug_assert!(self.is_announced(name), "{name} was not looked for before the run");
        let path = self.file(name);
        self.own.claim_growing(name).and_then(|()| File::create(&path)).map_err(|error| write_failure(&path, &error))
    }

    /// Renames a file that has finished growing; returns its path.
    pub fn keep(&self, grown: &str, name: &str) -> Outcome<PathBuf> {
        debug_assert!(self.is_announced(name), "{name} was not looked for before the run");
        let _uninterrupted = UninterruptedWork::begin();
        let (from, to) = (self.file(grown), self.file(name));
        let kept = self.own.claim(name, &from).and_then(|()| fs::rename(&from, &to));
        kept.and_then(|()| self.own.end_growing(grown)).map_err(|error| write_failure(&to, &error))?;
        Ok(to)
    }

    /// Removes files of this kind that earlier runs have left, after this run has written its own.
    pub fn clear_older(&self, files: &str) -> Outcome<()> {
        for name in self.present(files)? {
            let ours = self.own.owner(&name) == Owner::Ours;
            if !ours || self.own.is_of_this_run(&name) {
                continue;
            }
            let path = self.file(&name);
            fs::remove_file(&path).map_err(|error| read_error(&path, &error))?;
        }
        Ok(())
    }

    /// Rejects a folder with a file that would be lost.
    fn refuse_foreign(&self) -> Outcome<()> {
        for files in self.files {
            for name in self.present(files)? {
                let path = self.file(&name);
                let what = match self.own.owner(&name) {
                    Owner::Ours => continue,
                    Owner::Changed => "has been changed since this command wrote it",
                    Owner::Foreign => "was not written by this command",
                };
                return Err(Failure::new(format!("{} {what} and would be lost", path.display()))
                    .with_help("name another folder by --out DIR, or move this file elsewhere; it is left as it is"));
            }
        }
        Ok(())
    }

    /// Sorted names of existing files of this kind.
    fn present(&self, files: &str) -> Outcome<Vec<String>> {
        let inner = Path::new(files).parent().unwrap_or(Path::new(""));
        let folder = self.path.join(inner);
        let entries = match fs::read_dir(&folder) {
            // A path that is not a folder is reported when the folder is created.
            Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
                return Ok(Vec::new());
            }
            entries => entries.map_err(|error| read_error(&folder, &error))?,
        };
        let mut names = Vec::new();
        for entry in entries {
            let name = inner.join(entry.map_err(|error| read_error(&folder, &error))?.file_name());
            names.extend(name.to_str().filter(|name| matches_pattern(files, name)).map(str::to_owned));
        }
        names.sort();
        Ok(names)
    }

    fn is_announced(&self, name: &str) -> bool {
        self.files.iter().any(|files| matches_pattern(files, name))
    }
}

/// Returns true if a name matches a pattern with at most one `*`.
fn matches_pattern(files: &str, name: &str) -> bool {
    let Some((before, behind)) = files.split_once('*') else { return files == name };
    name.len() >= before.len() + behind.len() && name.starts_with(before) && name.ends_with(behind)
}

fn read_error(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format!("cannot prepare {}: {error}", path.display()))
        .with_help("make it readable and writable, or name another folder by --out DIR")
}

/// Creates a folder that `--out` names.
pub fn make(folder: &Path) -> Outcome<()> {
    fs::create_dir_all(folder).map_err(|error| {
        Failure::new(format!("cannot make the folder {}: {error}", folder.display()))
            .with_help("name a folder that can be written by --out DIR")
    })
}

/// Rejects a file for an option if it cannot be written, or if the command reads it: writing would destroy the input.
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

/// Checks the files of several options, which must differ. "-" is standard output, which only JSON may use.
pub fn check_files(wanted: &[(&str, Option<&Path>)], read: &[&Path]) -> Outcome<()> {
    let files = wanted.iter().filter_map(|(option, file)| Some((*option, (*file)?)));
    let (out, files): (Vec<_>, Vec<_>) = files.partition(|(_, file)| is_standard_output(file));
    if let Some((option, _)) = out.iter().find(|(option, _)| *option != "json") {
        return Err(Failure::new(format!("--{option} -: only JSON can be written to standard output"))
            .with_help("name a file; one whose name begins with a dash is ./-"));
    }
    for (place, (option, file)) in files.iter().enumerate() {
        check_file(option, file, read)?;
        if let Some((other, _)) = files[..place].iter().find(|(_, before)| before == file) {
            return Err(Failure::new(format!("--{other} and --{option} both name {}", file.display()))
                .with_help("name a file for each"));
        }
    }
    Ok(())
}

/// Name of a joint, or a number, as part of a file name.
pub fn file_part(joint: &str) -> String {
    joint.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = "report.html";

    #[test]
    fn impossible_folder_fails_before_the_run() {
        for folder in ["/dev/full/x", "/proc/x", "/dev/null"] {
            let failure =
                Folder::prepare(Some(Path::new(folder)), "hil", "Q1", &[REPORT]).expect_err("cannot be written");
            assert!(failure.message().contains(folder), "{failure}");
            assert!(failure.help().is_some(), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    /// Files that joint has not written, or that changed since, are never overwritten.
    #[test]
    fn foreign_and_changed_files_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let choose = || Folder::choose(Some(folder.path()), "sim", "Q1", &[REPORT, "runs/*.mcap"]);
        let refused = |name: &str, words: &str| {
            let failure = choose().expect_err("it would be lost");
            assert!(failure.message().contains(name) && failure.message().contains(words), "{failure}");
            assert!(failure.help().is_some_and(|help| help.contains("--out DIR")), "{failure}");
        };
        fs::create_dir(folder.path().join("runs")).expect("room");
        for name in [REPORT, "runs/a.mcap"] {
            let path = folder.path().join(name);
            fs::write(&path, "my thesis").expect("room");
            refused(name, "was not written by this command");
            fs::remove_file(&path).expect("there");
            let ours = choose().expect("nothing of anyone");
            ours.make().and_then(|()| ours.write_text(name, "ours")).expect("room");
            choose().expect("ours is replaced by the next one");
            fs::write(&path, "ours, with a note").expect("room");
            refused(name, "has been changed");
            fs::remove_file(&path).expect("there");
        }
        fs::write(folder.path().join("notes.txt"), "mine").expect("room");
        choose().expect("no run writes to this one");
    }

    #[test]
    fn only_files_of_earlier_runs_are_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let prepare = || Folder::prepare(Some(folder.path()), "hil", "Q1", &["*.mcap"]).expect("of ours");
        prepare().write_text("old.mcap", "1").expect("room");
        prepare().write_text("both.mcap", "1").expect("room");
        let second = prepare();
        second.write_text("both.mcap", "1").and_then(|()| second.write_text("new.mcap", "1")).expect("room");
        fs::write(folder.path().join("mine.mcap"), "put there meanwhile").expect("room");
        second.clear_older("*.mcap").expect("may be written");
        let left = second.present("*.mcap").expect("a folder");
        assert_eq!(left, ["both.mcap", "mine.mcap", "new.mcap"]);
    }

    #[test]
    fn folder_has_one_writer() {
        let folder = tempfile::tempdir().expect("a folder");
        let choose = || Folder::choose(Some(folder.path()), "sim", "Q1", &[REPORT]).expect("of ours");
        let (one, other) = (choose(), choose());
        one.make().expect("nobody else does");
        let failure = other.make().expect_err("its files would be mixed with those of the first");
        assert!(failure.message().contains("another run") && failure.help().is_some(), "{failure}");
        one.write_text(REPORT, "1").expect("room");
        // The lock ends with the process, however it ends.
        drop(one);
        other.make().expect("nobody else does any more");
        other.write_text(REPORT, "2").expect("what the first has written is known by now");
        choose();
    }

    #[test]
    fn default_folder_is_below_working_folder() {
        assert_eq!(default_folder("hil/tests", "Q1 b"), Path::new("joint-out/hil/tests/q1-b"));
    }

    #[test]
    #[cfg(unix)]
    fn link_or_folder_is_not_overwritten() {
        let folder = tempfile::tempdir().expect("a folder");
        let report = folder.path().join(REPORT);
        let choose = || Folder::choose(Some(folder.path()), "sim", "Q1", &[REPORT]);
        std::os::unix::fs::symlink(folder.path().join("not yet there"), &report).expect("room");
        assert!(choose().is_err());
        fs::remove_file(&report).expect("there");
        fs::create_dir(&report).expect("room");
        assert!(choose().is_err());
    }

    #[test]
    fn grown_file_is_renamed() {
        let folder = tempfile::tempdir().expect("a folder");
        let prepare = || Folder::prepare(Some(folder.path()), "sim", "Q1", &["part.csv", "whole.csv"]);
        for _ in 0..2 {
            let ours = prepare().expect("a folder of ours");
            ours.grow("part.csv")
                .and_then(|mut file| {
                    file.write_all(b"1").expect("room");
                    ours.keep("part.csv", "whole.csv")
                })
                .expect("room");
        }
        assert!(!folder.path().join("part.csv").exists() && folder.path().join("whole.csv").exists());
        fs::write(folder.path().join("part.csv"), "mine").expect("room");
        assert!(prepare().is_err(), "it grows no longer");
    }

    #[test]
    fn unwritable_file_fails_before_the_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let refused = |file: &Path| check_file("json", file, &[]).expect_err("no file").message().contains("--json");
        assert!(refused(&folder.path().join("none/out.json")) && refused(folder.path()));
        assert!(check_file("json", Path::new("out.json"), &[]).is_ok());
    }

    /// A file that is read is never overwritten, whichever path names it.
    #[test]
    fn input_file_is_not_overwritten() {
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
    fn options_do_not_share_a_file() {
        let [one, other] = ["a.json", "b.xml"].map(|name| Some(Path::new(name)));
        assert!(check_files(&[("json", one), ("junit", other)], &[]).is_ok());
        let failure = check_files(&[("json", one), ("junit", one)], &[]).expect_err("the same file");
        assert!(failure.message().contains("--json and --junit"), "{failure}");
        let out = Some(Path::new("-"));
        assert!(check_files(&[("json", out), ("html", other)], &[]).is_ok());
        let failure = check_files(&[("json", out), ("html", out)], &[]).expect_err("no JSON");
        assert!(failure.message().contains("--html -") && failure.help().is_some(), "{failure}");
    }

    #[test]
    fn joint_name_becomes_file_name() {
        assert_eq!(file_part("Q1 (b 0.5)"), "q1--b-0-5-");
    }
}

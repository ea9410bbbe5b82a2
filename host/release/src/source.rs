//! Sources of a release: the commit, its date, and the refusal of a work tree that differs from it.

use std::path::Path;
use std::process::Command;

use board::device::tool;
use report::failure::{Failure, Outcome};

/// Limit of the changed files in an error.
const SHOWN: usize = 5;

/// Commit that a release is built from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Commit, 40 hexadecimal digits.
    pub commit: String,
    /// Date of the commit [s since 1970], which stands in archives in place of the time of the build.
    pub time: u64,
    /// Date of the commit in ISO 8601, UTC.
    pub date: String,
}

impl Source {
    /// Reads the commit of a work tree. Refuses a tree that differs from its commit.
    pub fn read(workspace: &Path) -> Outcome<Self> {
        let source = Self::of_commit(workspace)?;
        let changes = git(workspace, &["status", "--porcelain"])?;
        if changes.is_empty() { Ok(source) } else { Err(changed(&source.commit, &changes)) }
    }

    /// Reads the commit of a work tree, which may differ from it.
    pub fn of_commit(workspace: &Path) -> Outcome<Self> {
        let git = |arguments: &[&str]| git(workspace, arguments);
        let commit = git(&["rev-parse", "HEAD"]).map_err(|failure| {
            Failure::new(format!("{} has no commit: {}", workspace.display(), failure.message().trim_end()))
                .with_help("run the command in a clone of the project's repository")
        })?;
        let log = |format: &str| git(&["log", "-1", "--date=format-local:%Y-%m-%dT%H:%M:%SZ", format]);
        let time = log("--format=%ct")?;
        let time = time.parse().map_err(|_| Failure::new(format!("git: the date of {commit} is `{time}`")))?;
        Ok(Self { date: log("--format=%cd")?, commit, time })
    }
}

fn git(workspace: &Path, arguments: &[&str]) -> Outcome<String> {
    let mut command = Command::new("git");
    command.arg("-C").arg(workspace).args(arguments).env("TZ", "UTC");
    tool::capture_output(&mut command).map(|text| text.trim_end().to_owned())
}

/// Failure of a work tree with changes.
fn changed(commit: &str, changes: &str) -> Failure {
    let mut lines: Vec<&str> = changes.lines().take(SHOWN).collect();
    if changes.lines().count() > SHOWN {
        lines.push("...");
    }
    Failure::new(format!("the work tree differs from its commit {commit}:\n{}", lines.join("\n")))
        .with_help("commit the changes, or put them aside: git stash --include-untracked")
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn set_up(folder: &Path, arguments: &[&str]) {
        let mut command = Command::new("git");
        command.arg("-C").arg(folder).args(["-c", "user.name=a", "-c", "user.email=a@b"]).args(arguments);
        command.env("GIT_COMMITTER_DATE", "2026-11-30T12:00:00+02:00");
        tool::capture_output(&mut command).expect("git");
    }

    /// A clean tree has commit and date; a changed and an untracked file are refused by name, with the remedy.
    #[test]
    fn changed_work_tree_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let failure = Source::read(folder.path()).expect_err("no repository");
        assert!(failure.message().contains("has no commit") && failure.help().is_some(), "{failure}");
        set_up(folder.path(), &["init", "--quiet"]);
        fs::write(folder.path().join("a.txt"), "1").expect("room");
        set_up(folder.path(), &["add", "."]);
        set_up(folder.path(), &["commit", "--quiet", "--message", "a"]);
        let source = Source::read(folder.path()).expect("a clean tree");
        assert_eq!((source.commit.len(), &*source.date, source.time), (40, "2026-11-30T10:00:00Z", 1_796_032_800));
        for name in ["a.txt", "new.txt"] {
            fs::write(folder.path().join(name), "2").expect("room");
            let failure = Source::read(folder.path()).expect_err("changed");
            assert!(failure.message().contains(name) && failure.message().contains(&source.commit), "{failure}");
            assert!(failure.help().is_some_and(|help| help.contains("git stash")), "{failure}");
            assert_eq!(failure.exit_code(), 2);
            set_up(folder.path(), &["stash", "--quiet", "--include-untracked"]);
        }
    }
}

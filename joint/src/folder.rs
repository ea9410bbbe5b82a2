//! The folder that a command writes its results to, and the file that its record is asked for in. What cannot be
//! written is found before the work begins; what is written there is the command's business.

use std::fs;
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};
use crate::record::write_text;
use crate::target::toolchain::workspace;

/// Makes a folder and tries to write to it. Where none is wanted it is `target/KIND/JOINT`.
pub fn prepare(wanted: Option<&Path>, kind: &str, joint: &str) -> Outcome<PathBuf> {
    let folder = wanted.map_or_else(|| workspace().join("target").join(kind).join(file_part(joint)), Path::to_owned);
    make(&folder)?;
    let probe = folder.join(".can-be-written");
    write_text(&probe, "")?;
    // It was ours, and it was empty: nothing is lost if it stays.
    let _ = fs::remove_file(&probe);
    Ok(folder)
}

/// Makes a folder that `--out` names.
pub fn make(folder: &Path) -> Outcome<()> {
    fs::create_dir_all(folder).map_err(|error| {
        Failure::new(format!("cannot make the folder {}: {error}", folder.display()))
            .with_help("name a folder that can be written by --out DIR")
    })
}

/// Refuses a file for `--json` that cannot be one.
pub fn check_json(json: &Path) -> Outcome<()> {
    let parent = json.parent().filter(|parent| !parent.as_os_str().is_empty());
    if let Some(parent) = parent.filter(|parent| !parent.is_dir()) {
        return Err(Failure::new(format!("there is no folder {} for --json", parent.display()))
            .with_help("create it first, or name another file"));
    }
    if json.is_dir() {
        return Err(Failure::new(format!("--json {} is a folder", json.display())).with_help("name a file in it"));
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
            let failure = prepare(Some(Path::new(folder)), "hil", "Q1").expect_err("cannot be written");
            assert!(failure.message().contains(folder), "{failure}");
            assert!(failure.help().is_some(), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    #[test]
    fn a_json_file_in_no_folder_is_found_before_the_run() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(check_json(&folder.path().join("none/out.json")).is_err());
        assert!(check_json(folder.path()).is_err());
        assert!(check_json(Path::new("out.json")).is_ok());
    }

    #[test]
    fn a_joints_name_makes_a_folder() {
        assert_eq!(file_part("Q1 (b 0.5)"), "q1--b-0-5-");
    }
}

//! The command as the user sees it: its output and its exit codes.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_report-diff")).args(arguments).output().expect("it can be started")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a name in UTF-8")
}

/// Exit codes: 0 for equal trees, 1 for different ones, 2 for bad usage.
#[test]
fn exit_code_states_the_outcome() {
    let folder = tempfile::tempdir().expect("a folder");
    let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
    for tree in [&old, &new] {
        fs::create_dir(tree).expect("made");
        fs::write(tree.join("a.json"), "{\"date\":\"2026-11-22\",\"x\":[1,2,3]}").expect("written");
    }
    let same = run(&[text(&old), text(&new)]);
    assert_eq!(same.status.code(), Some(0));
    let printed = String::from_utf8_lossy(&same.stdout).into_owned();
    assert_eq!(printed, "ignored: date 1 (0 of them different)\nsame: 3 values in 1 file\n");
    fs::write(new.join("a.json"), "{\"date\":\"2026-11-22\",\"x\":[1,4,5]}").expect("written");
    let different = run(&["--shown", "1", text(&old), text(&new)]);
    assert_eq!(different.status.code(), Some(1));
    let printed = String::from_utf8_lossy(&different.stdout).into_owned();
    assert!(printed.starts_with("a.json: x[1]\n    old: 2\n    new: 4\na.json: 1 more\n"), "{printed}");
    assert!(printed.ends_with("different: 2 of 3 values, in 1 of 1 file\n"), "{printed}");
    let (old, new) = (text(&old), text(&new));
    let bad: [&[&str]; 5] = [&[], &[old], &["--nonsense", old, new], &["--html", "some", old, new], &["none", new]];
    for arguments in bad {
        let ended = run(arguments);
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8_lossy(&ended.stderr).starts_with("error: "), "{arguments:?}");
    }
    assert_eq!(run(&["--help"]).status.code(), Some(0));
    assert!(String::from_utf8_lossy(&run(&["--ignored"]).stdout).contains("key git_commit: commit"));
}

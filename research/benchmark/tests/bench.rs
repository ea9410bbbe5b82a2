//! `joint bench` as a user meets it: the comparison of one case on the emulated core, and what it says to bad input. The
//! libraries of the host are left out: they take minutes to build.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use report::schema::assert_valid;
use serde_json::Value;

/// Runs the program to its end, with an output that is as wide as its messages.
fn bench(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_benchmark"));
    command.args(arguments).env("NO_COLOR", "1").env("COLUMNS", "400").stdin(Stdio::null());
    command.output().expect("the program can be started")
}

fn err(ended: &Output) -> String {
    String::from_utf8_lossy(&ended.stderr).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("temporary folders have plain names")
}

#[test]
fn a_case_that_is_not_known_is_named_with_those_that_are() {
    let ended = bench(&["--case", "A,Z"]);
    assert_eq!(ended.status.code(), Some(2));
    assert!(err(&ended).contains("--case Z") && err(&ended).contains("A, Q, R"), "{}", err(&ended));
}

#[test]
fn seeds_that_are_none_and_joints_without_teeth_are_told() {
    refused(&["--random", "9-8"], &["--random", "the range of seeds 9-8 is empty"]);
    refused(&["--random", "7005"], &["--random 7005", "equivalent gears", "help:"]);
}

#[test]
fn a_joint_file_that_is_not_there_is_named() {
    let ended = bench(&["no/such/joint.toml"]);
    assert_eq!(ended.status.code(), Some(2));
    assert!(err(&ended).contains("no/such/joint.toml"), "{}", err(&ended));
}

/// Bad input: exit code 2 with all these words in the message, and no panic.
#[track_caller]
fn refused(arguments: &[&str], words: &[&str]) {
    let ended = bench(arguments);
    assert_eq!(ended.status.code(), Some(2), "{arguments:?}: {}", err(&ended));
    let said = err(&ended).replace(['│', '╰', '─', '├', '▶'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.iter().all(|word| said.contains(word)) && !said.contains("panicked"), "{arguments:?}: {said}");
}

#[test]
fn a_file_that_is_nothing_is_refused_by_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let all_bytes: Vec<u8> = (0..=255).collect();
    let inputs: [(&str, &[u8]); 3] = [("empty", b""), ("garbage", &all_bytes), ("no-utf8", b"name = \"\xff\"\n")];
    for (name, content) in inputs {
        let file = folder.path().join(name);
        std::fs::write(&file, content).expect("a file");
        refused(&[text(&file)], &[text(&file), "help:"]);
    }
    refused(&[text(folder.path())], &[text(folder.path()), "help:"]);
}

#[test]
fn a_result_that_cannot_be_written_is_known_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let nowhere = folder.path().join("none/x");
    for option in ["--json", "--html", "--document"] {
        refused(&["--case", "A", option, text(&nowhere)], &["none", option]);
        refused(&["--case", "A", option, text(folder.path())], &["is a folder", option]);
    }
    refused(&["--case", "A", "--document", "no-such.md"], &["no-such.md", "Markdown"]);
    let file = folder.path().join("joint.toml");
    std::fs::write(&file, joint_file::preset("q1").expect("a preset")).expect("a file");
    refused(&[text(&file), "--html", text(&file)], &["would write over", "name another file"]);
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn the_peers_are_as_lean_as_their_advocates_would_have_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let document = folder.path().join("budget.md");
    std::fs::write(&document, "# Before\n").expect("written");
    let ended = bench(&["--case", "A", "--no-libraries", "--json", "-", "--document", text(&document)]);
    assert_eq!(ended.status.code(), Some(0), "{}", err(&ended));
    let figures: Value = serde_json::from_slice(&ended.stdout).expect("JSON");
    assert_valid("bench.schema.json", &figures);
    // At the finest step, where contacts seldom change within one; mean instructions a step.
    let finest = |method: &str| {
        let entries = figures["methods"].as_array().expect("a list").iter();
        let marks =
            entries.filter(|entry| entry["method"] == method).filter_map(|entry| entry["marks"].as_array()?.last());
        marks.filter_map(|mark| mark["instructions"].as_f64()).fold(0.0, f64::max)
    };
    // What throwaway prototypes of the same methods took.
    for (method, bound) in [
        ("runge_kutta4", 1100.0),
        ("runge_kutta4_tanh", 2572.0),
        ("euler", 284.0),
        ("trapezoid", 700.0),
        ("paper_etd1", 554.0),
    ] {
        let found = finest(method);
        assert!(found > 100.0 && found <= bound, "{method}: {found} instructions, {bound} allowed");
    }
    let written = std::fs::read_to_string(&document).expect("readable");
    assert!(written.starts_with("# Before\n") && written.contains("### Case A"), "{written}");
    assert!(folder.path().join("error-by-cost-a.svg").exists());
}

//! `joint bench` as the user sees it: the comparison of one case on the emulated core, and its errors for bad input. The libraries of the
//! host are left out: they take minutes to build.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use published_schema::assert_valid;
use serde_json::Value;

/// Runs the program to its end, with output as wide as its messages.
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

/// An unknown case is named together with the known ones.
#[test]
fn unknown_case_lists_the_known_ones() {
    let ended = bench(&["--case", "A,Z"]);
    assert_eq!(ended.status.code(), Some(2));
    assert!(err(&ended).contains("--case Z") && err(&ended).contains("A, Q, R"), "{}", err(&ended));
}

/// Empty seed ranges and joints without teeth are rejected.
#[test]
fn unusable_seeds_are_rejected() {
    refused(&["--random", "9-8"], &["--random", "the range of seeds 9-8 is empty"]);
    refused(&["--random", "7005"], &["--random 7005", "equivalent gears", "help:"]);
}

/// A missing joint file is named.
#[test]
fn missing_joint_file_is_named() {
    let ended = bench(&["no/such/joint.toml"]);
    assert_eq!(ended.status.code(), Some(2));
    assert!(err(&ended).contains("no/such/joint.toml"), "{}", err(&ended));
}

/// Checks bad input: exit code 2 with all `words` in the message, and no panic.
#[track_caller]
fn refused(arguments: &[&str], words: &[&str]) {
    let ended = bench(arguments);
    assert_eq!(ended.status.code(), Some(2), "{arguments:?}: {}", err(&ended));
    let printed = err(&ended).replace(['│', '╰', '─', '├', '▶'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.iter().all(|word| printed.contains(word)) && !printed.contains("panicked"),
        "{arguments:?}: {printed}"
    );
}

/// Unreadable joint files are named.
#[test]
fn unreadable_file_is_named() {
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

/// Outputs that cannot be written are rejected before the work.
#[test]
fn unwritable_output_is_rejected_early() {
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

/// Each method takes at most the instructions of a dedicated prototype.
#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn baselines_are_as_lean_as_prototypes() {
    let folder = tempfile::tempdir().expect("a folder");
    let document = folder.path().join("budget.md");
    std::fs::write(&document, "# Before\n").expect("written");
    let ended = bench(&["--case", "A", "--no-libraries", "--json", "-", "--document", text(&document)]);
    assert_eq!(ended.status.code(), Some(0), "{}", err(&ended));
    let figures: Value = serde_json::from_slice(&ended.stdout).expect("JSON");
    assert_valid("bench.schema.json", &figures);
    // Finest step, where contacts seldom change within a step; mean instructions a step.
    let finest = |method: &str| {
        let entries = figures["methods"].as_array().expect("a list").iter();
        let marks =
            entries.filter(|entry| entry["method"] == method).filter_map(|entry| entry["marks"].as_array()?.last());
        marks.filter_map(|mark| mark["instructions"].as_f64()).fold(0.0, f64::max)
    };
    // Instructions of throwaway prototypes of the same methods.
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

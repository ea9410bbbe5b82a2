//! The command as users see it: its files, exit codes, and messages with a remedy.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use super::plan;

fn joint_paper(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_paper"));
    command.args(words).current_dir(folder).output().expect("the command starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A small study writes report, record, pictures and tables.
#[test]
fn small_study_writes_all_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let words =
        ["paper", "--b", "10,60", "--grid", "58:62:2", "--expect", "1,3", "--out", "out", "--json", "study.json"];
    let output = joint_paper(folder.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(table.contains("period 3") && table.contains("from rest"), "{table}");
    let out = folder.path().join("out");
    for name in [
        "report.html",
        "study.json",
        "attractors.csv",
        "bifurcation-paper-rest.csv",
        "bifurcation-paper-rest.svg",
        "figure-3-stiffness.svg",
        "figure-4-dead-zone.svg",
        "attractor-paper-b60-portrait.svg",
        "poincare-points-paper.csv",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let text = fs::read_to_string(folder.path().join("study.json")).expect("the record");
    let record: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(record["readings"][0]["attractors"][1]["period"], 3);
    assert_eq!(record["readings"][0]["sweeps"][0]["points"].as_array().map(Vec::len), Some(3));
    let checks = record["checks"].as_array().expect("checks");
    let agree: Vec<_> = checks
        .iter()
        .filter(|check| check["name"].as_str().is_some_and(|name| name.ends_with("attractor and diagram agree")))
        .collect();
    assert_eq!(agree.len(), 1, "10 um is not in the diagram");
    assert_eq!(
        (agree[0]["verdict"].as_str(), agree[0]["note"].as_str()),
        (Some("passed"), Some("attractor: period 3, diagram: period 3"))
    );
    let page = fs::read_to_string(out.join("report.html")).expect("the report");
    for text in ["PASSED", "Fig. 3.", "Poincaré", "period 3", "Bifurcation diagram", "The parameters are ours"] {
        assert!(page.contains(text), "{text}");
    }
    for text in ["<script", "<link", "@import", "url(", " src=", " href="] {
        assert!(!page.contains(text), "{text}");
    }
}

/// Files that the user has put into the folder are not overwritten.
#[test]
fn user_files_are_not_overwritten() {
    for name in ["report.html", "study.json", "stiffness.csv", "bifurcation-mine.svg", "attractor-mine.svg"] {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join(name), "mine").expect("room");
        let output = joint_paper(folder.path(), &["paper", "--b", "10", "--out", "."]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(stderr(&output).contains(&format!("{name} was not written by this command")), "{}", stderr(&output));
        assert_eq!(fs::read_to_string(folder.path().join(name)).expect("still there"), "mine");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing was written");
    }
}

/// An unexpected attractor is reported, and the report is kept.
#[test]
fn unexpected_chaos_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["paper", "--b", "120", "--grid", "120:120:1", "--expect", "3", "--out", "out"];
    let output = joint_paper(folder.path(), &words);
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(text.contains("at b = 120 um period 3 was asked for") && text.contains("settles on chaos"), "{text}");
    assert!(folder.path().join("out/report.html").is_file());
}

/// Bad input is rejected before anything is written.
#[test]
fn bad_input_is_rejected_early() {
    let folder = tempfile::tempdir().expect("a folder");
    let smooth = joint_file::preset("paper").expect("a preset").replace("\"sharp\"", "\"tanh\"\nsharpness = 1000.0");
    fs::write(folder.path().join("smooth.toml"), smooth).expect("a file");
    let without =
        joint_file::preset("paper").expect("a preset").replace("half_backlash_um = 60.0", "half_backlash_um = 0.0");
    fs::write(folder.path().join("without.toml"), without).expect("a file");
    fs::write(folder.path().join("broken.toml"), [0xff, 0xfe, 0x00]).expect("a file");
    fs::write(folder.path().join("empty.toml"), "").expect("a file");
    fs::write(folder.path().join("same.toml"), joint_file::preset("paper").expect("a preset")).expect("a file");
    for (words, expected) in [
        (&["l1"][..], "--omega"),
        (&["smooth.toml"], "dead_zone = \"sharp\""),
        (&["without.toml"], "--grid"),
        (&["broken.toml"], "not text"),
        (&["empty.toml"], "empty.toml"),
        (&["same.toml", "--json", "same.toml"], "would write over"),
        (&["nowhere.toml"], "presets"),
        (&["."], "folder"),
        (&["paper", "--grid", "0:150:0"], "from:to:step"),
        (&["paper", "--grid", "0:150:1e-9"], "20000"),
        (&["paper", "--grid", "-1:150:1"], "negative"),
        (&["paper", "--b", "a"], "not a number"),
        (&["paper", "--b", "-5"], "negative"),
        (&["paper", "--omega", "0"], "between 0.001 and 100"),
        (&["paper", "--omega", "nan"], "between 0.001 and 100"),
        (&["paper", "--expect", "1,2"], "4 half-backlashes"),
        (&["paper", "--json", "nowhere/x.json"], "nowhere"),
        (&["paper", "--json", "."], "folder"),
        (&["paper", "--out", "/dev/null/x"], "--out"),
    ] {
        let mut all = words.to_vec();
        if !words.contains(&"--out") {
            all.extend(["--out", "made"]);
        }
        let output = joint_paper(folder.path(), &all);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", stderr(&output));
        let text = stderr(&output);
        assert!(text.contains(expected) && text.contains("help:"), "{words:?}: {text}");
        assert!(!folder.path().join("made/report.html").exists(), "{words:?}");
    }
}

/// Only the paper's own settings are compared with known numbers.
#[test]
fn only_set_p_has_known_numbers() {
    assert!(plan(&[]).expect("a good plan").is_set_p);
    for words in [&["paper"][..], &["--omega", "2.0"], &["--b", "1"], &["--grid", "0:1:1"]] {
        assert!(!plan(words).expect("a good plan").is_set_p, "{words:?}");
    }
    let plan = plan(&[]).expect("a good plan");
    assert_eq!(plan.subjects.len(), 2);
    assert_eq!(plan.grid.len(), 301);
    assert!((plan.values[3] - 120e-6).abs() < 1e-15 && (plan.grid[300] - 150e-6).abs() < 1e-15);
}

//! The width probe in a test file: a held link gives the width, a free link gives a reason, and an unsupported role is
//! rejected.

mod command;

use std::fs;
use std::path::Path;

use command::{Ended, folder, joint, json, text};
use serde_json::Value;

fn run(folder: &Path, test: &str, options: &[&str]) -> Ended {
    let file = folder.join("probe.toml");
    fs::write(&file, test).expect("a file");
    joint(&[&["hil", text(&file), "--out", text(&folder.join("out"))], options].concat())
}

fn first_run(folder: &Path) -> Value {
    json(&folder.join("out/record.json"))["tests"][0]["runs"].as_array().expect("runs")[0].clone()
}

#[test]
fn probe_held_link_gives_width() {
    let folder = folder();
    let test = "profile = \"held\"\n[assert]\nprobe_error_percent = \"<= 10\"\nprobe_time_ms = \"<= 500\"\n";
    run(folder.path(), test, &["--host"]).succeeded();
    let run = first_run(folder.path());
    assert_eq!((&run["controller"], &run["figures"]["probe_refused"]), (&"probe".into(), &0.0.into()));
    assert!(run["refusal"].is_null(), "{run}");
}

#[test]
fn probe_free_link_gives_reason() {
    let folder = folder();
    let free =
        "profile = \"held\"\n[known]\nload_coulomb_friction_N_m = 0.05\n[assert]\nprobe_error_percent = \"<= 10\"\n";
    let ended = run(folder.path(), free, &["--host"]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.out.contains("the width probe refused"), "{ended:?}");
    assert!(ended.out.contains("refused: seed 1: ") && ended.out.contains("hold the load"), "{ended:?}");
    assert_eq!(first_run(folder.path())["figures"]["probe_refused"], 1.0);
}

#[test]
fn probe_unsupported_role_rejected() {
    let folder = folder();
    let loop_ = run(folder.path(), "profile = \"held\"\n", &["--role", "loop"]);
    assert_eq!(loop_.code, Some(2), "{loop_:?}");
    assert!(loop_.err.contains("the role `loop` does not know") && loop_.err.contains("--role observer"), "{loop_:?}");
    let figure = run(folder.path(), "profile = \"T2\"\n[assert]\nprobe_refused = \"== 0\"\n", &["--host"]);
    assert_eq!(figure.code, Some(2), "{figure:?}");
    assert!(figure.err.contains("is about the width probe"), "{figure:?}");
}

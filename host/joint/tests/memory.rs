//! `joint memory` with files, and with the board's own firmware in a thread behind a pseudo-terminal.

mod command;
mod learning;
mod pseudo_terminal;
#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod thread_board;

use std::fs;
use std::path::{Path, PathBuf};

use command::{Ended, folder, joint, text};
use identify::memory::Content;
use learning::learnt;
use model_core::observer::{MEMORY_BYTES, Memory};
use tempfile::TempDir;
use thread_board::Flash;

/// One second, enough to estimate the width.
const PERIODS: u32 = 10_000;

/// Memory of joint Q1 whose true backlash is wider than stated, as a file.
fn stored(folder: &TempDir) -> (PathBuf, Memory) {
    let q1 = learning::joint(&[]);
    let wide = learning::joint(&[("mesh.half_backlash_um", "55")]);
    let (memory, _) = learnt(&q1, &wide, PERIODS);
    let path = folder.path().join("q1.memory");
    fs::write(&path, memory).expect("written");
    (path, memory)
}

/// Starts a board behind a port; the file keeps the port open.
fn board(changes: &[(&str, &str)], flash: &Flash) -> (String, fs::File) {
    let (master, slave, path) = pseudo_terminal::pair();
    let joint = learning::joint(changes);
    thread_board::start_observer(master, move || learning::controller(&joint), flash.clone());
    (path, slave)
}

fn memory(words: &[&str], port: &str) -> Ended {
    joint(&[&["memory"], words, &["--port", port]].concat())
}

/// A run on the host saves a board's memory, with the joint file that it belongs to.
#[test]
fn host_run_saves_memory() {
    let folder = folder();
    let test = folder.path().join("learning.toml");
    fs::write(&test, "duration_s = 3\nsettle_s = 0.5\nprofile = \"T2\"\n[controller]\nrivals = []\n").expect("room");
    let out = folder.path().join("out");
    joint(&["hil", text(&test), "--host", "--memory", "--out", text(&out)]).succeeded();
    let run = &command::json(&out.join("record.json"))["tests"][0]["runs"][0];
    let memory = out.join(run["memory"].as_str().expect("it was to be kept"));
    assert_eq!(fs::metadata(&memory).expect("written").len(), MEMORY_BYTES as u64);
    let told = memory.with_extension("toml");
    let shown = joint(&["memory", "show", text(&memory), "--joint", text(&told)]).succeeded().out;
    assert!(shown.contains("half-backlash b"), "{shown}");
    joint(&["memory", "show", text(&memory), "--joint", "s1"]).refused(&["another joint"]);
    joint(&["hil", text(&test), "--memory"]).refused(&["--host"]);
    joint(&["hil", text(&test), "--host", "--out", text(&out)]).succeeded();
    assert!(!memory.exists() && !told.exists(), "what an older run has learnt is not of this one");
}

#[test]
fn show_prints_units_beside_joint_file() {
    let folder = folder();
    let (path, memory) = stored(&folder);
    let shown = joint(&["memory", "show", text(&path)]).succeeded();
    let line = |name: &str| shown.out.lines().find(|line| line.starts_with(name)).unwrap_or_default().to_owned();
    let width = line("half-backlash b");
    assert!(width.contains(" um ") && width.ends_with("40.00"), "{}", shown.out);
    assert!(line("compliance at the output").contains("urad/(N m)"), "{}", shown.out);
    assert!(line("output encoder: error twice a turn").contains("may well be zero"), "{}", shown.out);
    let json = joint(&["memory", "show", text(&path), "--json", "-"]).succeeded();
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(json["schema"], "joint-memory/1");
    let value = json["values"][0]["value"].as_f64().expect("a width");
    assert!((value - 55.0).abs() < 5.0, "{value}");
    assert_eq!(fs::read(&path).expect("a file"), memory, "looking changes nothing");
    let q1 = learning::joint(&[]);
    fs::write(&path, learnt(&q1, &q1, 0).0).expect("written");
    let shown = joint(&["memory", "show", text(&path)]).succeeded();
    assert_eq!(shown.out.matches("not learnt").count(), 12, "nobody has moved it: {}", shown.out);
}

/// Conversions of units from the memory agree with the estimates of the observer.
#[test]
fn show_equals_estimates() {
    let q1 = learning::joint(&[]);
    let (memory, said) = learnt(&q1, &learning::joint(&[("mesh.half_backlash_um", "55")]), PERIODS);
    let loaded = joint_file::named::load(Path::new("q1")).expect("a preset");
    let content = Content::read(&memory, &loaded).expect("its own");
    let near = |name: &str, factor: f64, said: f32| {
        let shown = content.value(name).expect("learnt");
        let said = factor * f64::from(said);
        assert!((shown - said).abs() <= 1e-3 * said.abs(), "{name}: {shown} shown, {said} said");
    };
    near("half-backlash b", 1e6, said.half_backlash.value);
    near("compliance at the output", 1e6, said.compliance.value);
    near("encoder offset at the output", 1e3, said.encoder_offset.value);
    near("dry friction of the motor", 1.0, said.motor_friction.value);
}

#[test]
fn memory_round_trip_over_line() {
    let folder = folder();
    let (path, bytes) = stored(&folder);
    let flash = Flash::empty();
    let (port, _open) = board(&[], &flash);
    memory(&["read", text(&folder.path().join("none"))], &port)
        .refused(&["has no stored memory", "joint memory keep --port"]);
    memory(&["write", text(&path)], &port).succeeded();
    assert_eq!(flash.kept(), Some(bytes));
    let copy = folder.path().join("copy");
    let read = memory(&["read", text(&copy)], &port).succeeded();
    assert!(read.out.contains("half-backlash b"), "{}", read.out);
    assert_eq!(fs::read(&copy).expect("read"), bytes);
    memory(&["erase"], &port).succeeded();
    assert_eq!(flash.kept(), None);
    memory(&["keep"], &port).succeeded();
    assert!(flash.kept().is_some(), "what it has learnt so far");
}

#[test]
fn memory_of_other_joint_rejected() {
    let folder = folder();
    let (path, _) = stored(&folder);
    let flash = Flash::empty();
    let (port, _open) = board(&[("mesh.half_backlash_um", "30")], &flash);
    memory(&["write", text(&path)], &port).refused(&["q1.memory", "another joint", "load this joint's own"]);
    assert_eq!(flash.kept(), None, "nothing was written");
    joint(&["memory", "show", text(&path), "--joint", "l1"]).refused(&["q1.memory", "another joint"]);
}

#[test]
fn bad_memory_file_rejected_before_board() {
    let folder = folder();
    let (path, bytes) = stored(&folder);
    let damaged = folder.path().join("damaged.memory");
    let mut changed = bytes;
    changed[300] ^= 4;
    fs::write(&damaged, changed).expect("written");
    let short = folder.path().join("short.memory");
    fs::write(&short, &bytes[..100]).expect("written");
    let foreign = folder.path().join("foreign.memory");
    fs::write(&foreign, [7; MEMORY_BYTES]).expect("written");
    let missing = folder.path().join("missing.memory");
    for verb in ["show", "write"] {
        let refused = |file: &Path, words: &[&str]| joint(&["memory", verb, text(file)]).refused(words);
        refused(&damaged, &["damaged.memory", "the memory is damaged", "load a copy"]);
        refused(&short, &["short.memory", "it has 100 bytes, and a memory has 544"]);
        refused(&foreign, &["foreign.memory", "no memory of an observer"]);
        refused(&missing, &["missing.memory", "cannot read", "joint memory read"]);
        refused(folder.path(), &["it is a folder"]);
    }
    joint(&["memory", "show", text(&path), "--joint", "no_such"]).refused(&["no_such"]);
}

#[test]
fn flash_faults_name_remedy() {
    let folder = folder();
    let (path, bytes) = stored(&folder);
    let mut changed = bytes;
    changed[300] ^= 4;
    let flash = Flash::holding(&changed);
    let (port, _open) = board(&[], &flash);
    let out = folder.path().join("out");
    memory(&["read", text(&out)], &port).refused(&["the memory is damaged", "joint memory erase --port"]);
    assert!(!out.exists());
    // The supply was cut during the write.
    let (port, _cut) = board(&[], &Flash::with([None; 2]));
    memory(&["read", text(&out)], &port).refused(&["cannot be read", "joint memory erase --port"]);
    let worn = Flash::empty();
    worn.cells().works = false;
    let (port, _worn) = board(&[], &worn);
    memory(&["write", text(&path)], &port).refused(&["does not read back as written"]);
    memory(&["keep"], &port).refused(&["does not read back as written"]);
    let starved = Flash::empty();
    starved.cells().is_starved = true;
    let (port, _starved) = board(&[], &starved);
    memory(&["keep"], &port).refused(&["supply", "nothing was changed"]);
}

#[test]
fn plant_board_names_observer_image() {
    let (master, _slave, port) = pseudo_terminal::pair();
    drop(thread_board::start(master, thread_board::Misbehaviour::None));
    memory(&["erase"], &port)
        .refused(&["role `plant`, which estimates no parameters", "cargo joint flash q1 --role observer"]);
}

#[test]
fn silent_or_missing_port_is_named() {
    let (_master, _slave, port) = pseudo_terminal::pair();
    memory(&["erase"], &port).refused(&["no board answers", &port]);
    memory(&["erase"], "/dev/no-such-port").refused(&["/dev/no-such-port"]);
}

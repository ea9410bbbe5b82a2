//! The command on the emulated board: the real firmware, the real emulator, runs that succeed and runs that are cut
//! off. These tests build images and take a while, so they are left out of a plain `cargo test`.

#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod learning_board;

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A message is due within 2 s by design; a busy machine is given ten times that.
const LIVENESS: Duration = Duration::from_secs(20);
/// Longest wait for a run to have begun: the image may have to be built first.
const BUILD: Duration = Duration::from_secs(900);

fn hil(out: &Path) -> Command {
    hil_of(Path::new("q1"), out)
}

fn hil_of(joint: &Path, out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
    command.stdin(Stdio::null()).arg("hil").arg(joint).arg("--out").arg(out);
    command
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn finish(command: &mut Command) -> (Output, String) {
    let output = command.output().expect("the command starts");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(!said.contains("panicked"), "{said}");
    (output, said)
}

fn record(out: &TempDir) -> serde_json::Value {
    let text = fs::read_to_string(out.path().join("record.json")).expect("the record was kept");
    serde_json::from_str(&text).expect("a whole record")
}

fn check<'r>(record: &'r serde_json::Value, name: &str) -> &'r serde_json::Value {
    let checks = record["checks"].as_array().expect("checks");
    checks.iter().find(|check| check["name"].as_str().is_some_and(|check| check.contains(name))).expect("a check")
}

/// Processes whose parent is this one, by `/proc`.
fn children(parent: u32) -> Vec<u32> {
    let is_child = |process: &u32| {
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
        status.lines().any(|line| line.strip_prefix("PPid:").is_some_and(|id| id.trim() == parent.to_string()))
    };
    let processes = fs::read_dir("/proc").expect("Linux").flatten();
    processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok()).filter(is_child).collect()
}

/// An emulator that runs an image, not one that is asked for its version.
fn is_emulator(process: u32) -> bool {
    let line = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
    let mut words = line.split(|byte| *byte == 0);
    words.next().is_some_and(|program| program.ends_with(b"qemu-system-arm")) && words.any(|word| word == b"-kernel")
}

/// Whether a process has computed for about a second: user and system time in hundredths, fields 14 and 15.
fn has_worked(process: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    after_name.split_whitespace().skip(11).take(2).filter_map(|time| time.parse::<u32>().ok()).sum::<u32>() >= 100
}

fn is_alive(process: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    // A zombie whose parent has gone is taken by init in a moment; it is dead all the same.
    !status.is_empty() && !status.lines().any(|line| line.starts_with("State:") && line.contains('Z'))
}

fn signal(process: u32, name: &str) {
    let status = Command::new("kill").args([name, &process.to_string()]).status().expect("kill");
    assert!(status.success());
}

/// Waits for a condition; fails after `limit`.
fn until<T>(limit: Duration, what: &str, mut condition: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = condition() {
            return found;
        }
        assert!(start.elapsed() < limit, "{what} did not come about within {limit:?}");
        thread::sleep(Duration::from_millis(20));
    }
}

/// A long run in its middle, and its emulator.
fn long_run(out: &TempDir) -> (Child, u32) {
    let mut command = hil(out.path());
    command.args(["--duration", "3600", "--no-reference"]).stderr(Stdio::piped()).stdout(Stdio::null());
    let mut child = command.spawn().expect("the command starts");
    let joint = child.id();
    let emulator = until(BUILD, "an emulator", || {
        assert!(child.try_wait().expect("a child").is_none(), "the run ended early");
        children(joint).into_iter().find(|&process| is_emulator(process))
    });
    until(BUILD, "a run", || has_worked(emulator).then_some(()));
    (child, emulator)
}

fn end(mut child: Child) -> (Option<i32>, String) {
    let start = Instant::now();
    let status = until(LIVENESS, "the end of the command", || child.try_wait().expect("a child"));
    assert!(start.elapsed() < LIVENESS);
    let mut said = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("text");
    assert!(!said.contains("panicked"), "{said}");
    (status.code(), said)
}

fn assert_incomplete(out: &TempDir) {
    let record = record(out);
    assert_eq!(record["completeness"]["state"], "interrupted");
    assert!(record["samples"]["tick"].as_array().is_some_and(|ticks| !ticks.is_empty()), "samples were kept");
    let report = fs::read_to_string(out.path().join("report.html")).expect("the report was kept");
    assert!(report.contains("INCOMPLETE"));
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn the_default_run_holds_every_check_and_leaves_a_decoded_log_line() {
    let out = folder();
    let json = out.path().join("copy.json");
    let (output, said) = finish(hil(out.path()).arg("--json").arg(&json));
    assert_eq!(output.status.code(), Some(0), "{said}");
    let record = record(&out);
    assert!(check(&record, "steps equal to the twin's")["figure"].as_f64().is_some_and(|steps| steps >= 1e5));
    assert!(record["log"].as_array().is_some_and(|lines| !lines.is_empty()), "no log line");
    assert!(fs::read_to_string(out.path().join("log.txt")).is_ok_and(|text| !text.is_empty()));
    assert_eq!(record["identity"]["emulated"], true);
    assert!(record["identity"]["image"]["elf_sha256"].as_str().is_some_and(|hash| hash.len() == 64));
    assert_eq!(fs::read(json).expect("a copy"), fs::read(out.path().join("record.json")).expect("the record"));
    assert!(said.contains("EMULATED"), "{said}");
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn a_recorded_drive_in_real_time_equals_the_twin() {
    let out = folder();
    let drive = out.path().join("drive.csv");
    let row = |k: u32| {
        let time = 0.007 * f64::from(k);
        format!("{time},{},{}\n", 0.8 * (9.0 * time).sin(), 4.8 * (9.0 * time).sin())
    };
    let rows: String = (0..150).map(row).collect();
    fs::write(&drive, format!("time_s,motor_torque_Nm,load_torque_Nm\n{rows}")).expect("a file");
    let (_, said) = finish(hil(out.path()).args(["--mode", "realtime", "--no-reference", "--profile"]).arg(&drive));
    let record = record(&out);
    assert_eq!(record["completeness"]["state"], "complete", "{said}");
    assert_eq!(check(&record, "differ from the host's f32 twin")["figure"], 0.0, "{said}");
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn a_joint_file_that_is_not_in_the_repository_runs_beside_the_presets() {
    let out = folder();
    let file = out.path().join("mine.toml");
    let text = joint_file::preset("l1").expect("a preset").replace("name = \"L1\"", "name = \"Mine\"");
    fs::write(&file, text).expect("a file");
    let (_, said) = finish(hil_of(&file, out.path()).args(["--duration", "0.5", "--no-reference"]));
    let record = record(&out);
    assert_eq!(record["identity"]["joint"], "Mine", "{said}");
    assert_eq!(check(&record, "differ from the host's f32 twin")["figure"], 0.0, "{said}");
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn an_emulator_killed_in_mid_run_is_named_and_the_record_is_kept() {
    let out = folder();
    let (child, emulator) = long_run(&out);
    signal(emulator, "-KILL");
    let (code, said) = end(child);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("the emulator has ended") && said.contains("what was recorded"), "{said}");
    assert_incomplete(&out);
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn ctrl_c_leaves_a_record_and_no_emulator() {
    let out = folder();
    let (child, emulator) = long_run(&out);
    signal(child.id(), "-INT");
    let (code, said) = end(child);
    assert_eq!(code, Some(130), "{said}");
    assert_incomplete(&out);
    until(LIVENESS, "the emulator's end", || (!is_alive(emulator)).then_some(()));
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn even_a_killed_command_leaves_no_emulator() {
    assert!(Path::new("/usr/bin/setpriv").exists(), "needs setpriv of util-linux, as every Debian has it");
    let out = folder();
    let (mut child, emulator) = long_run(&out);
    signal(child.id(), "-KILL");
    child.wait().expect("it ends");
    until(LIVENESS, "the emulator's end", || (!is_alive(emulator)).then_some(()));
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn images_of_several_joints_lie_side_by_side() {
    let image = |joint: &str| -> PathBuf {
        let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
        let (output, said) = finish(command.args(["image", joint]));
        assert_eq!(output.status.code(), Some(0), "{said}");
        PathBuf::from(String::from_utf8_lossy(&output.stdout).lines().next().expect("a path"))
    };
    let (one, other) = (image("q1"), image("l1"));
    assert_ne!(one, other);
    assert!(one.is_file() && other.is_file());
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn the_whole_loop_has_the_faults_of_a_test_as_the_host_has_them() {
    let out = folder();
    let file = out.path().join("faults.toml");
    let mut text = "duration_s = 0.5\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nrivals = []\n".to_owned();
    let faults = [
        "kind = \"encoder_noise\"\nnoise_counts = 3\nencoder = \"motor\"",
        "kind = \"encoder_eccentric\"\nerror_deg = 0.05",
        "kind = \"encoder_missing_counts\"\nshare = 0.01",
        "kind = \"encoder_offset\"\ncounts = -20",
        "kind = \"torque_bias\"\nratio = 0.05\ntorque_N_m = 0.02",
        "kind = \"torque_saturation\"\ntorque_N_m = 1.5",
        "kind = \"lost_frames\"\nshare = 0.05",
        "kind = \"encoder_frozen\"",
    ];
    for (number, fault) in faults.iter().enumerate() {
        let start = 0.05 + 0.05 * number as f64;
        text += &format!("[[fault]]\n{fault}\nstart_s = {start}\nend_s = {}\n", start + 0.1);
    }
    fs::write(&file, text + "[assert]\nfault_found_ms = \"<= 400\"\n").expect("a file");
    let (output, said) = finish(hil_of(&file, out.path()).args(["--role", "loop"]));
    assert_eq!(output.status.code(), Some(0), "{said}");
    let board = record(&out)["tests"][0]["runs"][0]["board"].clone();
    assert_eq!((board["role"].as_str(), board["same_periods"].as_u64()), (Some("loop"), Some(5000)), "{said}");
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn a_memory_is_judged_by_the_firmware_of_the_emulated_board() {
    let folder = folder();
    let q1 = learning_board::joint(&[]);
    let file = folder.path().join("learnt.memory");
    fs::write(&file, learning_board::learnt(&q1, &q1, 1000).0).expect("a file");
    let memory = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
        let (output, said) = finish(command.env("COLUMNS", "400").arg("memory").args(words));
        (output.status.code(), said)
    };
    let file = file.to_str().expect("a plain name");
    for role in ["observer", "loop"] {
        let (code, said) = memory(&["write", file, "--role", role]);
        assert!(code == Some(0) && said.contains("is good") && said.contains("no flash"), "{said}");
    }
    let (code, said) = memory(&["write", file, "--joint", "l1"]);
    assert!(code == Some(2) && said.contains("another joint"), "{said}");
    let (code, said) = memory(&["read", file]);
    assert!(code == Some(2) && said.contains("has no flash"), "{said}");
    let (code, said) = memory(&["erase"]);
    assert!(code == Some(0) && said.contains("keeps no memory now"), "{said}");
}

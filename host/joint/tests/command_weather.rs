//! The command itself, in good weather and bad, on a board in a thread behind a pseudo-terminal: exit codes, messages,
//! what is kept. The emulator and the firmware are left to `emulated_board`.

#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod fake_board;
mod pseudo_terminal;

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use fake_board::Misbehaviour;
use tempfile::TempDir;

/// A message is due within 2 s by design; a busy machine is given ten times that.
const LIVENESS: Duration = Duration::from_secs(20);

/// A board behind a port; the port stays open as long as this.
struct BoardBehindPort {
    path: String,
    _slave: File,
}

impl BoardBehindPort {
    fn new(misbehaviour: Misbehaviour) -> Self {
        let (master, slave, path) = pseudo_terminal::pair();
        // The thread ends with the test's process: a pseudo-terminal does not end while one side is open.
        drop(fake_board::start(master, misbehaviour));
        Self { path, _slave: slave }
    }

    fn path(&self) -> String {
        self.path.clone()
    }
}

fn joint() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
    command.stdin(Stdio::null());
    command
}

fn hil(port: &str, out: &Path) -> Command {
    hil_for("1", port, out)
}

fn hil_for(duration: &str, port: &str, out: &Path) -> Command {
    let mut command = joint();
    command.args(["hil", "q1", "--port", port, "--no-build", "--no-reference", "--duration", duration, "--out"]);
    command.arg(out);
    command
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn finish(command: &mut Command) -> (Output, String) {
    let start = Instant::now();
    let output = command.output().expect("the command starts");
    assert!(start.elapsed() < LIVENESS, "it took {:?}", start.elapsed());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!said.contains("panicked"), "{said}");
    (output, said)
}

fn run(misbehaviour: Misbehaviour) -> (Output, String, TempDir) {
    let board = BoardBehindPort::new(misbehaviour);
    let out = folder();
    let (output, said) = finish(&mut hil(&board.path(), out.path()));
    (output, said, out)
}

fn record(out: &TempDir) -> serde_json::Value {
    let text = std::fs::read_to_string(out.path().join("record.json")).expect("the record was kept");
    serde_json::from_str(&text).expect("a whole record")
}

fn samples(record: &serde_json::Value) -> usize {
    record["samples"]["tick"].as_array().map_or(0, Vec::len)
}

#[test]
fn a_good_run_passes_and_leaves_report_record_and_log() {
    let (output, said, out) = run(Misbehaviour::None);
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}{shown}");
    assert!(shown.contains("steps equal to the twin's, bit for bit"), "{shown}");
    let record = record(&out);
    assert_eq!(record["completeness"]["state"], "complete");
    assert_eq!(samples(&record), 1000);
    assert!(out.path().join("report.html").is_file() && out.path().join("log.txt").is_file());
}

#[test]
fn a_check_that_does_not_hold_fails_the_run_by_name() {
    let (output, said, out) = run(Misbehaviour::Overruns(3));
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("did not hold: overruns"), "{said}");
    assert_eq!(record(&out)["completeness"]["state"], "complete");
    let (output, said, _) = run(Misbehaviour::LateTorques);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("twin"), "{said}");
}

#[test]
fn a_missing_port_is_named_before_anything_is_built() {
    let (output, said) = finish(joint().args(["hil", "--port", "/dev/no-such-port", "--out"]).arg(folder().path()));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("no serial port /dev/no-such-port") && said.contains("help:"), "{said}");
}

#[test]
fn a_busy_port_is_named() {
    let board = BoardBehindPort::new(Misbehaviour::None);
    let _holder = serialport::new(board.path(), 115_200).open_native().expect("the port is free");
    let (output, said) = finish(&mut hil(&board.path(), folder().path()));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains(&board.path()) && said.contains("busy"), "{said}");
}

#[test]
fn a_board_that_goes_away_leaves_an_incomplete_record() {
    let (output, said, out) = run(Misbehaviour::HangsUpAt(10_000));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("/dev/") && said.contains("was lost at tick"), "{said}");
    let record = record(&out);
    assert_eq!(record["completeness"]["state"], "interrupted");
    assert!(samples(&record) > 100, "{}", samples(&record));
    let page = std::fs::read_to_string(out.path().join("report.html")).expect("the report was kept");
    assert!(page.contains("INCOMPLETE"), "the report must say so");
}

#[test]
fn a_silent_board_a_deaf_line_and_garbage_are_told_apart() {
    let (output, said, out) = run(Misbehaviour::FallsSilentAt(10_000));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("fallen silent"), "{said}");
    assert!(samples(&record(&out)) > 100);
    assert!(run(Misbehaviour::Mute).1.contains("nothing came"));
    assert!(run(Misbehaviour::OnlyGarbage).1.contains("no valid frame"));
}

#[test]
fn another_board_is_refused_with_the_command_that_mends_it() {
    for misbehaviour in [Misbehaviour::AnotherDigest, Misbehaviour::AnotherRole, Misbehaviour::Protocol(7)] {
        let (output, said, _) = run(misbehaviour.clone());
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("cargo joint flash q1 --board stm32f405"), "{misbehaviour:?}: {said}");
    }
}

#[test]
fn a_half_frame_fails_the_run_but_does_not_end_it() {
    let (output, said, out) = run(Misbehaviour::HalfFrameAt(10_000));
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("bad frames at the host"), "{said}");
    assert_eq!(samples(&record(&out)), 1000);
}

#[test]
fn a_folder_that_cannot_be_written_is_found_before_the_run() {
    for bad in ["/proc/joint-report", "/dev/full"] {
        let (output, said) = finish(&mut hil("/dev/no-such-port", Path::new(bad)));
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(bad) && said.contains("--out"), "{said}");
    }
}

#[test]
fn a_full_disk_at_the_end_does_not_cost_the_record() {
    let board = BoardBehindPort::new(Misbehaviour::None);
    let out = folder();
    let (output, said) = finish(hil(&board.path(), out.path()).args(["--json", "/dev/full"]));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("cannot write /dev/full"), "{said}");
    assert!(said.contains(&out.path().display().to_string()), "where the record is: {said}");
    assert_eq!(samples(&record(&out)), 1000);
}

#[test]
fn ctrl_c_stops_the_run_and_keeps_the_record() {
    let board = BoardBehindPort::new(Misbehaviour::None);
    let out = folder();
    let mut child = hil_for("3600", &board.path(), out.path())
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .expect("the command starts");
    std::thread::sleep(Duration::from_secs(2));
    let process = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &process]).status().is_ok_and(|status| status.success()));
    let start = Instant::now();
    let status = child.wait().expect("it ends");
    assert!(start.elapsed() < LIVENESS);
    let mut said = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("text");
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(said.contains("stopped by the user") && said.contains("what was recorded"), "{said}");
    assert_eq!(record(&out)["completeness"]["state"], "interrupted");
}

#[test]
fn a_bad_profile_is_refused_by_file_and_line() {
    let folder = folder();
    let file = folder.path().join("drive.csv");
    std::fs::write(&file, "time_s,motor_torque_Nm,load_torque_Nm\n0,0,0\n1,NaN,0\n").expect("a file");
    let (output, said) = finish(joint().args(["hil", "--profile"]).arg(&file).arg("--out").arg(folder.path()));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("drive.csv: line 3: motor_torque_Nm is NaN"), "{said}");
    let (output, said) = finish(joint().args(["hil", "--profile", "no-such", "--out"]).arg(folder.path()));
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("built in: reversals"), "{said}");
}

#[test]
fn bad_arguments_and_bad_joint_files_exit_with_two() {
    let folder = folder();
    let bad = folder.path().join("bad.toml");
    std::fs::write(&bad, "name = \"bad\"\nunknown_key = 1\n").expect("a file");
    let bad = bad.display().to_string();
    let lines: [&[&str]; 6] = [
        &["hil", &bad],
        &["hil", "no-such.toml"],
        &["hil", "--decimation", "0"],
        &["hil", "--duration", "nonsense"],
        &["hil", "--duration", "-1"],
        &["sail"],
    ];
    for line in lines {
        let (output, said) = finish(joint().args(line));
        assert_eq!(output.status.code(), Some(2), "{line:?}: {said}");
        assert!(!said.is_empty(), "{line:?}");
    }
}

#[test]
fn without_a_subcommand_help_is_printed() {
    let (output, said) = finish(&mut joint());
    assert_eq!(output.status.code(), Some(0), "{said}");
    let help = String::from_utf8_lossy(&output.stdout);
    assert!(["hil", "check", "image", "flash"].iter().all(|name| help.contains(name)), "{help}");
    assert!(help.contains("real-time") || help.contains("microcontroller"), "{help}");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child =
        joint().args(["check", "q1"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && output.status.code() == Some(0), "{said}");
}

//! The command on a board in a thread behind a pseudo-terminal, in normal operation and in its failure modes: exit
//! codes, messages, saved files.

mod command;
mod pseudo_terminal;
#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod thread_board;

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

use command::{Ended, folder, interrupt, joint, json, start, text, until, wait};
use link::PROTOCOL_VERSION;
use serde_json::Value;
use tempfile::TempDir;
use thread_board::Misbehaviour;

/// Messages are due within 2 s by design; a busy machine gets ten times as long.
const LIVENESS: Duration = Duration::from_secs(20);

/// Path of a board's port, and a file that keeps the port open.
fn board(misbehaviour: Misbehaviour) -> (String, File) {
    let (path, slave, _) = counted_board(misbehaviour);
    (path, slave)
}

/// Board with a count of the bytes that it has sent.
fn counted_board(misbehaviour: Misbehaviour) -> (String, File, Arc<AtomicUsize>) {
    let (stream, slave, path) = pseudo_terminal::pair();
    let said = Arc::new(AtomicUsize::new(0));
    // The thread ends with the test's process: a pseudo-terminal stays open while one side is open.
    drop(thread_board::start(Counted { stream, said: said.clone() }, misbehaviour));
    (path, slave, said)
}

/// A stream that counts the bytes written to it.
struct Counted<S> {
    stream: S,
    said: Arc<AtomicUsize>,
}

impl<S: Read> Read for Counted<S> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.read(buffer)
    }
}

impl<S: Write> Write for Counted<S> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.stream.write(bytes)?;
        self.said.fetch_add(count, Relaxed);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// Command line of a run on a port.
fn line<'l>(duration: &'l str, port: &'l str, out: &'l Path) -> [&'l str; 10] {
    ["hil", "q1", "--port", port, "--no-build", "--no-reference", "--duration", duration, "--out", text(out)]
}

/// Runs the command and asserts that it ends in time.
fn finish(arguments: &[&str]) -> Ended {
    let start = Instant::now();
    let ended = joint(arguments);
    assert!(start.elapsed() < LIVENESS, "it took {:?}", start.elapsed());
    assert!(!ended.err.contains("panicked"), "{ended:?}");
    ended
}

fn run(misbehaviour: Misbehaviour) -> (Ended, TempDir) {
    let (port, _open) = board(misbehaviour);
    let out = folder();
    (finish(&line("1", &port, out.path())), out)
}

fn record(out: &TempDir) -> Value {
    json(&out.path().join("record.json"))
}

fn samples(record: &Value) -> usize {
    record["samples"]["tick"].as_array().map_or(0, Vec::len)
}

#[test]
fn good_run_writes_report_record_log() {
    let (ended, out) = run(Misbehaviour::None);
    let ended = ended.succeeded();
    assert!(ended.out.contains("steps equal to the twin's, bit for bit"), "{ended:?}");
    let record = record(&out);
    assert_eq!(record["completeness"]["state"], "complete");
    assert_eq!(samples(&record), 1000);
    assert!(out.path().join("report.html").is_file() && out.path().join("log.txt").is_file());
}

#[test]
fn failed_check_is_named() {
    let (ended, out) = run(Misbehaviour::Overruns(3));
    ended.exited(1, &["did not hold: overruns"]);
    assert_eq!(record(&out)["completeness"]["state"], "complete");
    run(Misbehaviour::LateTorques).0.exited(1, &["twin"]);
}

#[test]
fn missing_port_named_before_build() {
    finish(&["hil", "--port", "/dev/no-such-port", "--out", text(folder().path())])
        .refused(&["no serial port /dev/no-such-port", "help:"]);
}

#[test]
fn busy_port_is_named() {
    let (port, _open) = board(Misbehaviour::None);
    let _holder = serialport::new(&port, 115_200).open_native().expect("the port is free");
    finish(&line("1", &port, folder().path())).refused(&[&port, "busy"]);
}

#[test]
fn disconnected_board_leaves_partial_record() {
    let (ended, out) = run(Misbehaviour::HangsUpAt(10_000));
    ended.refused(&["/dev/", "was lost at tick"]);
    let record = record(&out);
    assert_eq!(record["completeness"]["state"], "interrupted");
    assert!(samples(&record) > 100, "{}", samples(&record));
    let page = fs::read_to_string(out.path().join("report.html")).expect("the report was kept");
    assert!(page.contains("INCOMPLETE"), "the report must say so");
}

#[test]
fn silence_mute_line_and_garbage_distinguished() {
    let (ended, out) = run(Misbehaviour::FallsSilentAt(10_000));
    ended.refused(&["fallen silent"]);
    assert!(samples(&record(&out)) > 100);
    run(Misbehaviour::Mute).0.refused(&["nothing came"]);
    run(Misbehaviour::OnlyGarbage).0.refused(&["no valid frame"]);
}

/// A board with another digest, role or protocol needs to be flashed.
#[test]
fn wrong_image_names_flash_command() {
    for misbehaviour in
        [Misbehaviour::AnotherDigest, Misbehaviour::AnotherRole, Misbehaviour::Protocol(PROTOCOL_VERSION + 1)]
    {
        run(misbehaviour).0.refused(&["cargo joint flash q1 --board NAME"]);
    }
}

#[test]
fn half_frame_fails_check_run_continues() {
    let (ended, out) = run(Misbehaviour::HalfFrameAt(10_000));
    ended.exited(1, &["bad frames at the host"]);
    assert_eq!(samples(&record(&out)), 1000);
}

#[test]
fn unwritable_folder_rejected_before_run() {
    for bad in ["/proc/joint-report", "/dev/full"] {
        finish(&line("1", "/dev/no-such-port", Path::new(bad))).refused(&[bad, "--out"]);
    }
}

#[test]
fn full_disk_at_end_keeps_record() {
    let (port, _open) = board(Misbehaviour::None);
    let out = folder();
    // The message also gives the path of the record.
    finish(&[&line("1", &port, out.path())[..], &["--json", "/dev/full"]].concat())
        .refused(&["cannot write /dev/full", text(out.path())]);
    assert_eq!(samples(&record(&out)), 1000);
}

#[test]
fn ctrl_c_keeps_record() {
    let (port, _open, said) = counted_board(Misbehaviour::None);
    let out = folder();
    let child = start(&line("3600", &port, out.path()));
    until("samples arrive", || said.load(Relaxed) > 20_000);
    interrupt(&child);
    let start = Instant::now();
    let ended = wait(child);
    assert!(start.elapsed() < LIVENESS);
    ended.exited(130, &["stopped by the user", "the recording"]);
    assert_eq!(record(&out)["completeness"]["state"], "interrupted");
}

#[test]
fn bad_profile_names_file_and_line() {
    let folder = folder();
    let file = folder.path().join("drive.csv");
    fs::write(&file, "time_s,motor_torque_Nm,load_torque_Nm\n0,0,0\n1,NaN,0\n").expect("a file");
    let profile = |name: &str| finish(&["hil", "--profile", name, "--out", text(folder.path())]);
    profile(text(&file)).refused(&["drive.csv: line 3: motor_torque_Nm is NaN"]);
    profile("no-such").refused(&["built in: reversals"]);
}

#[test]
fn bad_arguments_exit_with_two() {
    let folder = folder();
    let bad = folder.path().join("bad.toml");
    fs::write(&bad, "name = \"bad\"\nunknown_key = 1\n").expect("a file");
    let lines: [&[&str]; 6] = [
        &["hil", text(&bad)],
        &["hil", "no-such.toml"],
        &["hil", "--decimation", "0"],
        &["hil", "--duration", "nonsense"],
        &["hil", "--duration", "-1"],
        &["sail"],
    ];
    for line in lines {
        let ended = finish(line);
        ended.refused(&[]);
        assert!(!ended.err.is_empty(), "{line:?}");
    }
}

#[test]
fn no_subcommand_prints_help() {
    let Ended { out: help, .. } = finish(&[]).succeeded();
    assert!(["hil", "check", "image", "flash"].iter().all(|name| help.contains(name)), "{help}");
    assert!(help.contains("real-time") || help.contains("microcontroller"), "{help}");
}

#[test]
fn closed_pipe_is_no_error() {
    let mut child = start(&["check", "q1"]);
    drop(child.stdout.take());
    wait(child).exited(0, &[]);
}

#[test]
fn json_dash_prints_record_alone() {
    let (port, _open) = board(Misbehaviour::None);
    let out = folder();
    let ended = finish(&[&line("0.2", &port, out.path())[..], &["--json", "-"]].concat()).succeeded();
    assert_eq!(ended.out, fs::read_to_string(out.path().join("record.json")).expect("the record"));
    assert!(ended.err.contains("report: "), "{ended:?}");
}

/// Units and words of run.mcap equal those of record.json.
#[test]
fn mcap_log_matches_record() {
    let (ended, out) = run(Misbehaviour::None);
    ended.succeeded();
    let log = fs::read(out.path().join("run.mcap")).expect("written");
    let (summary, record) = (mcap::Summary::read(&log).expect("finished").expect("with a summary"), record(&out));
    let channel = summary.channels.values().next().expect("one channel");
    assert_eq!(channel.topic, "/joint/run");
    let messages: Vec<_> =
        mcap::MessageStream::new(&log).expect("MCAP").map(|message| message.expect("a message")).collect();
    assert_eq!(messages.len(), samples(&record));
    let last = messages.last().expect("samples");
    let number = |place: usize| f64::from_le_bytes(last.data[4 + 8 * place..][..8].try_into().expect("eight bytes"));
    let of_record = |name: &str| record["samples"][name].as_array().and_then(|column| column.last()?.as_f64());
    assert_eq!(Some(number(0)), of_record("time_s"));
    assert_eq!(last.log_time, (1e9 * number(0)).round() as u64, "the log's time is the board's");
    assert_eq!(Some(number(2)), of_record("link_angle_rad"));
    assert_eq!(Some(number(5) as f32), of_record("gap_m").map(|gap| gap as f32));
    let words = ["separated\0", "drive_side\0", "back_side\0"];
    assert!(words.iter().any(|word| last.data.ends_with(word.as_bytes())), "contact is a word");
}

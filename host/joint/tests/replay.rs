//! `joint replay` repeats a run of `joint hil TEST` in every bit, and feeds any other log to an observer.

mod command;

use std::fs;
use std::path::{Path, PathBuf};

use mcap::records::Metadata;
use mcap::{MessageStream, Writer};
use serde_json::Value;
use tempfile::TempDir;

use command::{SHORT_ROWS, joint, json, text, write_short_log};

/// Topic of the controller, and the offset of the motor counts: after the CDR header, time, period and clock.
const CONTROLLER: &str = "/joint/controller";
const MOTOR_COUNTS_AT: usize = 4 + 8 + 4 + 4;
/// A motion with enough excitation for every parameter.
const SWING: &str = "[profile]\nkind = \"random\"\namplitude_rad = 0.4\nhighest_Hz = 8\n[controller]\nrivals = []\n";

/// Runs a test on the host and returns the path of its only log.
fn log_of(folder: &Path, test: &str, plant: &str) -> PathBuf {
    let (file, out) = (folder.join("swing.toml"), folder.join("tests"));
    fs::write(&file, test).expect("room");
    joint(&["hil", text(&file), "--host", "--plant", plant, "--out", text(&out)]).succeeded();
    let mut logs = fs::read_dir(out.join("runs")).expect("it has logs").map(|entry| entry.expect("readable").path());
    logs.find(|path| path.extension().is_some_and(|ending| ending == "mcap")).expect("a log")
}

fn replayed(log: &Path, out: &Path) -> (Option<i32>, String, Value) {
    let ended = joint(&["replay", text(log), "--out", text(out)]);
    let record = json(&out.join("record.json"));
    (ended.code, ended.out + &ended.err, record)
}

fn find<'f>(findings: &'f Value, name: &str) -> &'f Value {
    let all = findings["findings"].as_array().expect("a list");
    all.iter().find(|finding| finding["name"] == name).expect(name)
}

/// Copies a log with the messages of a topic changed or removed.
fn changed(log: &Path, into: &Path, topic: &str, mut change: impl FnMut(u32, &mut Vec<u8>) -> bool) {
    let bytes = fs::read(log).expect("a log");
    let mut writer = Writer::new(std::io::BufWriter::new(fs::File::create(into).expect("room"))).expect("a log");
    let summary = mcap::Summary::read(&bytes).expect("whole").expect("with a summary");
    for index in summary.metadata_indexes {
        let metadata: Metadata = mcap::read::metadata(&bytes, &index).expect("it is there");
        writer.write_metadata(&metadata).expect("room");
    }
    for message in MessageStream::new(&bytes).expect("a log") {
        let mut message = message.expect("whole");
        let mut data = message.data.into_owned();
        if message.channel.topic != topic || change(message.sequence, &mut data) {
            message.data = data.into();
            writer.write(&message).expect("room");
        }
    }
    writer.finish().expect("room");
}

#[test]
fn run_with_faults_repeats_bit_exact() {
    let folder = TempDir::new().expect("a folder");
    let test = "duration_s = 1\nsettle_s = 0.5\nseeds = [3]\nprofile = \"T2\"\n[controller]\nrivals = []\nfrom_memory = true\n\
                [[fault]]\nkind = \"encoder_frozen\"\nstart_s = 0.4\nend_s = 0.5\n\
                [[fault]]\nkind = \"lost_frames\"\nshare = 0.3\nstart_s = 0.6\nend_s = 0.7\n";
    for plant in ["core", "reference"] {
        let log = log_of(folder.path(), test, plant);
        let (code, said, record) = replayed(&log, &folder.path().join("replay"));
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains("the observer repeats the run: 10000 control periods, every bit"), "{said}");
        assert_eq!((&record["periods"], &record["repeats"]["every_bit"]), (&10_000.into(), &true.into()));
        assert!(record["sources"].as_array().is_some_and(|sources| sources.len() > 1), "the fault is seen: {record}");
    }
}

#[test]
fn changed_count_names_first_difference() {
    let folder = TempDir::new().expect("a folder");
    let test = format!("duration_s = 0.5\nsettle_s = 0.2\n{SWING}");
    let log = log_of(folder.path(), &test, "core");
    let other = folder.path().join("changed.mcap");
    changed(&log, &other, CONTROLLER, |period, data| {
        if period == 3456 {
            data[MOTOR_COUNTS_AT] ^= 1;
        }
        true
    });
    let (code, said, record) = replayed(&other, &folder.path().join("replay"));
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("the first difference is in control period 3456, t = 0.3456 s"), "{said}");
    let first = &record["repeats"]["first_difference"];
    assert_eq!(first["period"], 3456);
    // Values are logged a thousand times a second.
    assert_eq!(first["values_period"], 3459);
    assert!(first["values"].as_array().is_some_and(|values| !values.is_empty()), "{first}");
}

#[test]
fn changed_estimate_or_lost_period_named() {
    let folder = TempDir::new().expect("a folder");
    let test = format!("duration_s = 0.3\nsettle_s = 0.1\n{SWING}");
    let log = log_of(folder.path(), &test, "core");
    let other = folder.path().join("changed.mcap");
    // The last bytes of a period are the digest of its estimates.
    changed(&log, &other, CONTROLLER, |period, data| {
        let last = data.len() - 1;
        data[last] ^= u8::from(period == 2000);
        true
    });
    let (code, said, record) = replayed(&other, &folder.path().join("replay"));
    assert_eq!((code, &record["repeats"]["differing_periods"]), (Some(1), &1.into()), "{said}");
    changed(&log, &other, CONTROLLER, |period, _| period != 1000);
    let ended = joint(&["replay", text(&other)]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.err.contains("control periods 1000 to 1000 of the run are missing"), "{}", ended.err);
    changed(&log, &other, CONTROLLER, |period, _| period >= 1000);
    let ended = joint(&["replay", text(&other)]);
    assert!(ended.err.contains("the run begins at control period 1000"), "{}", ended.err);
}

#[test]
fn log_without_counts_rejected() {
    let folder = TempDir::new().expect("a folder");
    let test = "duration_s = 0.2\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nmode = \"preview\"\nrivals = [\"motor_pid\"]\n";
    let log = log_of(folder.path(), test, "core");
    let rival = log.with_file_name("swing-seed1-motor_pid.mcap");
    let refused = joint(&["replay", text(&rival)]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("of this run of `motor_pid` has no observer's samples"), "{}", refused.err);
    assert!(refused.err.contains("use the log of its own controller"), "{}", refused.err);

    let csv = folder.path().join("log.csv");
    fs::write(&csv, "time_s,speed,motor_torque_N_m\n0,1,0\n0.0001,1,0\n").expect("room");
    let refused = joint(&["replay", text(&csv), "q1"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("an observer needs counts, and there is no column for the motor"), "{}", refused.err);
    assert!(refused.err.contains("--column motor_counts=NAME"), "{}", refused.err);
    let refused = joint(&["replay", text(&csv)]);
    assert!(refused.err.contains("does not say which joint it is of"), "{}", refused.err);
}

#[test]
fn any_log_feeds_observer() {
    let folder = TempDir::new().expect("a folder");
    let (log, out) = (folder.path().join("log.csv"), folder.path().join("out"));
    write_short_log(&log, SHORT_ROWS);
    let guess = ["--set", "half_backlash_um=60"];
    joint(&[&["replay", text(&log), "q1", "--out", text(&out)][..], &guess].concat()).succeeded();
    let record = json(&out.join("record.json"));
    assert!(record["repeats"].is_null() && record["counts_from_angles"] == false);
    let learnt = record["learnt"].as_array().expect("a list");
    let width = learnt.iter().find(|finding| finding["name"] == "half-backlash b").expect("it is learnt");
    // Accuracy that the observer's tests require, and an interval.
    assert!((width["value"].as_f64().expect("a number") / 40.0 - 1.0).abs() < 0.05, "{width}");
    assert!(width["interval"][0].as_f64() < width["interval"][1].as_f64(), "{width}");
    // CSV and MCAP have the same names, at the default thousand rows a second.
    let csv = fs::read_to_string(out.join("estimates.csv")).expect("written");
    let mut lines = csv.lines();
    let head: Vec<String> = lines.next().expect("a head").split(',').map(str::to_ascii_lowercase).collect();
    assert!(lines.clone().all(|line| line.split(',').count() == head.len()));
    let second: Vec<&str> = lines.nth(1).expect("rows").split(',').collect();
    assert_eq!(second[0], "0.001");
    let bytes = fs::read(out.join("estimates.mcap")).expect("written");
    let message = MessageStream::new(&bytes).expect("a log").next().expect("messages").expect("whole");
    let schema = String::from_utf8(message.channel.schema.as_ref().expect("one").data.to_vec()).expect("text");
    let fields: Vec<&str> = schema.lines().filter_map(|line| line.split(' ').nth(1)).collect();
    assert_eq!(fields, head);
}

/// The rows come at a rate below the lowest control rate of an observer.
#[test]
fn impossible_control_rate_not_recommended() {
    let folder = TempDir::new().expect("a folder");
    let log = folder.path().join("log.csv");
    let rows = (0..100).map(|row| format!("{},{row},{row},0\n", 2e-3 * f64::from(row)));
    fs::write(&log, "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned() + &rows.collect::<String>())
        .expect("room");
    let refused = joint(&["replay", text(&log), "q1"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("its rows have a rate of 500 Hz"), "{}", refused.err);
    assert!(refused.err.contains("must be from 1000 to 100000 Hz"), "{}", refused.err);
    assert!(!refused.err.contains("control_rate_Hz=500"), "{}", refused.err);
}

#[test]
fn wrong_row_rate_names_rate_key() {
    let folder = TempDir::new().expect("a folder");
    let log = folder.path().join("log.csv");
    let rows = (0..100).map(|row| format!("{},{row},{row},0\n", 1e-3 * f64::from(row)));
    fs::write(&log, "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned() + &rows.collect::<String>())
        .expect("room");
    let refused = joint(&["replay", text(&log), "q1"]);
    assert_eq!(refused.code, Some(2));
    let rates = "its rows have a rate of 1000 Hz, but the control rate of this joint is 10000 Hz";
    assert!(refused.err.contains(rates), "{}", refused.err);
    assert!(refused.err.contains("--set control_rate_Hz=1000"), "{}", refused.err);
    let out = folder.path().join("out");
    joint(&["replay", text(&log), "q1", "--set", "control_rate_Hz=1000", "--out", text(&out)]).succeeded();
}

#[test]
fn run_feeds_observer_of_other_joint() {
    let folder = TempDir::new().expect("a folder");
    let test = format!("duration_s = 0.5\nsettle_s = 0.2\n{SWING}");
    let log = log_of(folder.path(), &test, "core");
    let out = folder.path().join("out");
    joint(&["replay", text(&log), "q1", "--motor-only", "--out", text(&out)]).succeeded();
    let record = json(&out.join("record.json"));
    assert!(record["repeats"].is_null());
    assert_eq!(record["both_encoders_percent"], 0.0);
}

#[test]
fn identify_reads_log_of_test() {
    let folder = TempDir::new().expect("a folder");
    let truths = [
        ("half-backlash b", 40.0),
        ("dry friction of the motor", 0.03),
        ("motor encoder: error once a turn", 0.1),
        ("motor encoder: error twice a turn", 0.1),
        ("output encoder: age of a reading", 50.0),
    ];
    let log = log_of(folder.path(), &format!("duration_s = 6\nseeds = [1]\n{SWING}"), "reference");
    let out = folder.path().join("identified");
    joint(&["identify", text(&log), "--joint", "q1", "--out", text(&out)]).succeeded();
    let findings = json(&out.join("findings.json"));
    for (name, truth) in truths {
        let finding = find(&findings, name);
        let [low, high] = [0, 1].map(|end| finding["interval"][end].as_f64().expect(name));
        assert!(low <= truth && truth <= high, "{finding}");
    }

    // A link that hardly moves and reverses twice gives too few crossings.
    let still = "duration_s = 2\nsettle_s = 0.5\nseeds = [2]\n[profile]\nkind = \"sine\"\namplitude_rad = 0.02\nfrequency_Hz = 0.5\n\
                 [controller]\nrivals = []\n";
    let log = log_of(folder.path(), still, "reference");
    let out = folder.path().join("nothing");
    joint(&["identify", text(&log), "--joint", "q1", "--out", text(&out)])
        .refused(&["too few crossings: the carrying flank changes 2 times", "reverse the torque more often"]);
    // With more reversals the fit succeeds but adds no information to the joint file.
    let log = log_of(folder.path(), &still.replace("duration_s = 2", "duration_s = 10"), "core");
    let out = folder.path().join("no-news");
    joint(&["identify", text(&log), "--joint", "q1", "--out", text(&out)])
        .refused(&["nothing is identifiable", "record more reversals"]);
}

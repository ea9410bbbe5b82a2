//! Differences planted into a small tree of records: each is found at its place, and no others. The tree's files have the form that the
//! host command writes, with a figure or two.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, WriteOptions, Writer};
use report_diff::{Difference, Findings, Options, compare};
use tempfile::TempDir;

const RECORD: &str = r#"{"date":"2026-11-22T09:57:43Z","git_commit":"b1f3478181d7","seconds":3.5,
    "runs":[{"seed":1,"figures":{"rms_mrad":3.487969661470408,"crossings":8}},{"seed":2,"figures":{"rms_mrad":0.1}}]}"#;
const HISTORY: &str = "time_s,gap_m,contact\n0.0,8.18e-5,1\n5e-5,8.19e-5,1\n1e-4,8.21e-5,0\n";
const TERMINAL: &str = "ok    rms_mrad   3.488 mrad <= 5\nreport: /home/one/target/hil/report.html\n";
const PAGE: &str = "<h1>Q1</h1><p>2026-11-22T09:57:43Z</p><table><tr><th>figure</th><td>3.488 mrad</td></tr></table>";
const JUNIT: &str = "<testsuites tests=\"1\" time=\"3.500\"><testsuite name=\"hil/t2.toml\" timestamp=\"2026-11-22T09:57:43Z\">\
    <testcase name=\"rms_mrad &lt;= 5\"/></testsuite></testsuites>\n";
const PICTURE: &str = "<svg><path d=\"M 1.5 2.5\"/></svg>\n";

const SCHEMA: &str = "float64 time_s  # [s]\nfloat64 gap_um  # [um]\n";
const ROWS: [[f64; 2]; 3] = [[0.0, 81.8], [5e-5, 81.9], [1e-4, 82.1]];

/// Motion as an MCAP log of messages with two numbers.
fn motion(rows: &[[f64; 2]], date: &str, compression: Option<Compression>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let options = WriteOptions::new().compression(compression).library("joint 0.1.0");
    let mut writer = Writer::with_options(std::io::Cursor::new(&mut bytes), options).expect("a log");
    let schema = writer.add_schema("joint_msgs/msg/Motion", "ros2msg", SCHEMA.as_bytes()).expect("a schema");
    let channel = writer.add_channel(schema, "/joint/motion", "cdr", &BTreeMap::new()).expect("a topic");
    let remarks = BTreeMap::from([("date".to_owned(), date.to_owned()), ("joint".to_owned(), "Q1".to_owned())]);
    writer.write_metadata(&Metadata { name: "joint".into(), metadata: remarks }).expect("remarks");
    for (row, sequence) in rows.iter().zip(0_u32..) {
        let time = u64::from(sequence) * 50_000;
        let header = MessageHeader { channel_id: channel, sequence, log_time: time, publish_time: time };
        let mut message = vec![0, 1, 0, 0];
        row.iter().for_each(|number| message.extend(number.to_le_bytes()));
        writer.write_to_known_channel(&header, &message).expect("a message");
    }
    writer.finish().expect("its end");
    drop(writer);
    bytes
}

/// Tree of records.
struct Tree(TempDir);

impl Tree {
    fn new() -> Self {
        let tree = Self(tempfile::tempdir().expect("a folder"));
        tree.write("hil/record.json", RECORD);
        tree.write("hil/terminal.stdout", TERMINAL);
        tree.write("hil/report.html", PAGE);
        tree.write("hil/junit.xml", JUNIT);
        tree.write("sim/history.csv", HISTORY);
        tree.write("sim/picture.svg", PICTURE);
        tree.write("sim/history.mcap", motion(&ROWS, "2026-11-22T09:57:43Z", None));
        tree
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, content).expect("written");
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Replaces the first occurrence in a file's text.
    fn change(&self, name: &str, from: &str, to: &str) {
        let text = fs::read_to_string(self.path(name)).expect("a text");
        assert!(text.contains(from), "{name} has no {from}");
        self.write(name, text.replacen(from, to, 1));
    }
}

fn found(old: &Tree, new: &Tree) -> Findings {
    compare(old.0.path(), new.0.path(), Options::default()).expect("two trees")
}

/// Single difference caused by `plant`.
fn only(plant: impl FnOnce(&Tree)) -> Difference {
    let (old, new) = (Tree::new(), Tree::new());
    plant(&new);
    let mut differences = found(&old, &new).differences;
    assert_eq!(differences.len(), 1, "{differences:?}");
    differences.remove(0)
}

fn difference(file: &str, place: &str, old: Option<&str>, new: Option<&str>) -> Difference {
    let [old, new] = [old, new].map(|value| value.map(ToOwned::to_owned));
    Difference { file: file.into(), place: place.into(), old, new }
}

/// Equal trees have no difference.
#[test]
fn equal_trees_have_no_difference() {
    let found = found(&Tree::new(), &Tree::new());
    assert!(found.is_same(), "{:?}", found.differences);
    assert_eq!(found.files, 7);
    assert!(found.values > 40, "{}", found.values);
}

/// A changed last digit or sign in JSON is found.
#[test]
fn last_digit_in_json_is_found() {
    let digit = only(|tree| tree.change("hil/record.json", "3.487969661470408", "3.487969661470409"));
    let place = "runs[0].figures.rms_mrad";
    assert_eq!(digit, difference("hil/record.json", place, Some("3.487969661470408"), Some("3.487969661470409")));
    let sign = only(|tree| tree.change("hil/record.json", "\"crossings\":8", "\"crossings\":-8"));
    assert_eq!(sign.place, "runs[0].figures.crossings");
}

/// Notation of numbers and order of keys do not count.
#[test]
fn json_notation_and_key_order_are_ignored() {
    let (old, new) = (Tree::new(), Tree::new());
    new.change("hil/record.json", "{\"rms_mrad\":0.1}", "{ \"rms_mrad\": 1e-1 }");
    let (figures, turned) =
        ("\"rms_mrad\":3.487969661470408,\"crossings\":8", "\"crossings\":8,\"rms_mrad\":3.487969661470408");
    new.change("hil/record.json", figures, turned);
    assert!(found(&old, &new).is_same());
}

/// A removed and an added key are found.
#[test]
fn removed_and_added_json_keys_are_found() {
    let gone = only(|tree| tree.change("hil/record.json", ",\"crossings\":8", ""));
    assert_eq!(gone, difference("hil/record.json", "runs[0].figures.crossings", Some("8"), None));
    let come = only(|tree| tree.change("hil/record.json", "\"seed\":2", "\"seed\":2,\"broken\":null"));
    assert_eq!(come, difference("hil/record.json", "runs[1].broken", None, Some("null")));
}

/// A changed cell, a missing row and a missing column are one difference each.
#[test]
fn csv_changes_are_found() {
    let cell = only(|tree| tree.change("sim/history.csv", "8.19e-5", "8.20e-5"));
    assert_eq!(cell, difference("sim/history.csv", "line 3, gap_m", Some("8.19e-5"), Some("8.20e-5")));
    let row = only(|tree| tree.change("sim/history.csv", "5e-5,8.19e-5,1\n", ""));
    assert_eq!(row, difference("sim/history.csv", "line 3", Some("5e-5,8.19e-5,1"), None));
    let column = only(|tree| tree.write("sim/history.csv", "time_s,gap_m\n0.0,8.18e-5\n5e-5,8.19e-5\n1e-4,8.21e-5\n"));
    assert_eq!(column, difference("sim/history.csv", "columns, contact", Some("contact"), None));
}

/// A file on one side only is found.
#[test]
fn files_on_one_side_only_are_found() {
    let gone = only(|tree| fs::remove_file(tree.path("hil/junit.xml")).expect("removed"));
    assert_eq!(gone, difference("hil/junit.xml", "", Some("a file"), None));
    let come = only(|tree| tree.write("hil/deep/er/more.txt", "more"));
    assert_eq!(come, difference("hil/deep/er/more.txt", "", None, Some("a file")));
}

/// A changed or lost message is found with its field.
#[test]
fn changed_log_message_is_found_by_field() {
    let log = |rows: &[[f64; 2]]| motion(rows, "2026-11-22T09:57:43Z", None);
    let field = only(|tree| tree.write("sim/history.mcap", log(&[ROWS[0], [5e-5, 81.9_f64.next_up()], ROWS[2]])));
    assert_eq!((&*field.file, &*field.place), ("sim/history.mcap", "/joint/motion message 1, gap_um"));
    assert_eq!(field.old.as_deref(), Some("[81.9]"));
    let lost = only(|tree| tree.write("sim/history.mcap", log(&ROWS[..2])));
    let whole = "/joint/motion,100000,100000,2,[0.0001],[82.1]";
    assert_eq!(lost, difference("sim/history.mcap", "/joint/motion message 2", Some(whole), None));
}

/// A changed byte is found in a complete and in a truncated log.
#[test]
fn changed_byte_of_truncated_log_is_found() {
    let change = |tree: &Tree, length: Option<usize>| {
        let mut bytes = fs::read(tree.path("sim/history.mcap")).expect("a log");
        let wanted = 81.9_f64.to_le_bytes();
        let place = bytes.windows(8).position(|window| window == wanted).expect("not compressed");
        bytes[place] ^= 1;
        bytes.truncate(length.map_or(bytes.len(), |length| place + length));
        tree.write("sim/history.mcap", &bytes);
        (place, bytes.len())
    };
    let changed = only(|tree| {
        change(tree, None);
    });
    assert_eq!(changed.place, "/joint/motion message 1, gap_um");
    let (old, new) = (Tree::new(), Tree::new());
    let (place, length) = change(&new, Some(12));
    let whole = fs::read(old.path("sim/history.mcap")).expect("a log");
    old.write("sim/history.mcap", &whole[..length]);
    let differences = found(&old, &new).differences;
    assert_eq!(differences.len(), 1, "{differences:?}");
    assert!(differences[0].place.ends_with(&format!("byte {place}")), "{differences:?}");
    new.write("sim/history.mcap", &whole[..length]);
    assert!(found(&old, &new).is_same());
}

/// Compression and date of a log do not count.
#[test]
fn log_compression_and_date_are_ignored() {
    let (old, new) = (Tree::new(), Tree::new());
    new.write("sim/history.mcap", motion(&ROWS, "2027-01-01T00:00:00Z", Some(Compression::Lz4)));
    assert_ne!(fs::read(old.path("sim/history.mcap")).ok(), fs::read(new.path("sim/history.mcap")).ok());
    let found = found(&old, &new);
    assert!(found.is_same(), "{:?}", found.differences);
    assert_eq!(found.ignored_counts["date"].different, 1);
}

/// Changes of date, commit, folder and duration are ignored and counted.
#[test]
fn ignored_values_are_counted() {
    let (old, new) = (Tree::new(), Tree::new());
    new.change("hil/record.json", "2026-11-22T09:57:43Z", "2027-01-01T00:00:00Z");
    new.change("hil/record.json", "b1f3478181d7", "0000000000aa");
    new.change("hil/record.json", "\"seconds\":3.5", "\"seconds\":4.25");
    new.change("hil/report.html", "2026-11-22T09:57:43Z", "2027-01-01T00:00:00Z");
    new.change("hil/junit.xml", "time=\"3.500\"", "time=\"4.250\"");
    new.change("hil/terminal.stdout", "/home/one/target/hil/", "/elsewhere/");
    let found = found(&old, &new);
    assert!(found.is_same(), "{:?}", found.differences);
    let different = |rule: &str| found.ignored_counts[rule].different;
    assert_eq!((different("date"), different("commit"), different("folder"), different("host time")), (2, 1, 1, 2));
    let name = only(|tree| tree.change("hil/terminal.stdout", "report.html", "page.html"));
    assert_eq!(name.place, "line 2");
}

/// Changed lines, verdicts, figures and pictures are found.
#[test]
fn text_xml_html_and_svg_changes_are_found() {
    let line = only(|tree| tree.change("hil/terminal.stdout", "ok ", "FAILED "));
    assert_eq!((&*line.file, &*line.place), ("hil/terminal.stdout", "line 1"));
    let case = only(|tree| tree.change("hil/junit.xml", "tests=\"1\"", "tests=\"2\""));
    assert_eq!(case, difference("hil/junit.xml", "testsuites @tests", Some("1"), Some("2")));
    let path = only(|tree| tree.change("sim/picture.svg", "2.5", "2.6"));
    assert_eq!((&*path.file, &*path.place), ("sim/picture.svg", "byte 22"));
    let (old, new) = (Tree::new(), Tree::new());
    new.change("hil/report.html", "3.488", "3.489");
    let places: Vec<String> = found(&old, &new).differences.into_iter().map(|found| found.place).collect();
    let wanted = ["figure `3.488`", "figure `3.489`", "cell `3.488 mrad`", "cell `3.489 mrad`"];
    assert_eq!(places, wanted);
}

/// Figures that depend on the line's timing are ignored by name, and no other figure.
#[test]
fn line_timing_is_ignored_by_name() {
    let (old, new) = (Tree::new(), Tree::new());
    let checks = |idle: &str, longest: &str| {
        format!(
            "{{\"timing\":{{\"idle_percent\":{idle},\"max_s\":{longest}}},\"checks\":[{{\"name\":\"idle time\",\"figure\":{idle}}},\
             {{\"name\":\"longest tick\",\"figure\":{longest}}}]}}"
        )
    };
    let page = |idle: &str, longest: &str| {
        format!(
            "<div>{idle}<span> %</span></div><div>Idle <b>EMULATED</b></div><table><tr><td>idle time <b>EMULATED</b></td>\
             <td>{idle} %</td></tr><tr><td>longest</td><td>{longest} us</td></tr></table>"
        )
    };
    for (tree, idle) in [(&old, "61.1"), (&new, "60.9")] {
        tree.write("board/record.json", checks(idle, "25.8"));
        tree.write("board/report.html", page(idle, "25.8"));
        tree.write("board/terminal.stdout", format!("-   idle time   {idle} %   EMULATED\n"));
    }
    let differences = found(&old, &new).differences;
    assert!(differences.is_empty(), "{differences:?}");
    new.write("board/record.json", checks("60.9", "25.9"));
    new.write("board/report.html", page("60.9", "25.9"));
    let places: Vec<String> = found(&old, &new).differences.into_iter().map(|found| found.place).collect();
    let figures = ["figure `25.8`", "figure `25.9`", "cell `25.8 us`", "cell `25.9 us`"];
    assert_eq!(places[..2], ["checks[1].figure", "timing.max_s"]);
    assert_eq!(places[2..], figures);
}

/// Trees that cannot be compared are rejected.
#[test]
fn incomparable_trees_are_rejected() {
    let (tree, empty) = (Tree::new(), tempfile::tempdir().expect("a folder"));
    let refused = |old: &Path, new: &Path| compare(old, new, Options::default()).expect_err("refused");
    assert!(refused(empty.path(), tree.0.path()).contains("has no files"));
    assert!(refused(tree.0.path(), &tree.path("hil/record.json")).contains("one is a folder"));
    assert!(refused(&tree.path("missing"), &tree.path("missing")).contains("missing"));
}

//! Logs in users' formats: registers of other widths, bad readings, repeated time stamps, lines before the header, rows
//! without a value. Each log gives the findings of the plain format, or is rejected with a remedy.

mod command;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use command::{Ended, SHORT_ROWS, folder, joint, json, text, write_short_log};
use host_tests::extent::cases;
use serde_json::Value;

/// Simulated log of Q1: time, counts of motor and output, torque. Counts continue over turns.
fn rows(folder: &Path) -> Vec<[f64; 4]> {
    let path = folder.join("plain.csv");
    write_short_log(&path, SHORT_ROWS);
    let log = fs::read_to_string(&path).expect("written");
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        <[f64; 4]>::try_from(cells).expect("four columns")
    };
    log.lines().skip(1).map(row).collect()
}

fn write(folder: &Path, rows: &[[f64; 4]]) {
    let mut log = "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned();
    for [time, motor, output, torque] in rows {
        writeln!(log, "{time:.6},{motor},{output},{torque}").expect("a string");
    }
    fs::write(folder.join("log.csv"), log).expect("written");
}

fn identify(folder: &Path, options: &[&str]) -> Ended {
    let [log, out] = ["log.csv", "out"].map(|name| folder.join(name));
    joint(&[&["identify", text(&log), "--joint", "q1", "--out", text(&out)], options].concat())
}

/// Findings, and the notes on the log.
fn findings(folder: &Path) -> (Value, String) {
    let record = json(&folder.join("out/findings.json"));
    (record["findings"].clone(), record["assumptions"].to_string())
}

/// Checks that the true half-backlash and stiffness of Q1 are in their intervals.
fn assert_contains_truth(findings: &Value) {
    for (key, truth) in [("mesh.half_backlash_um", 40.0), ("compliance.stiffness_N_m_per_rad", 10.3e3)] {
        let all = findings.as_array().expect("a list");
        let one = all.iter().find(|one| one["key"] == key).expect(key);
        let [low, high] = [0, 1].map(|end| one["interval"][end].as_f64().expect("found"));
        assert!((low..=high).contains(&truth) && high - low < 0.1 * truth, "{key}: {low} to {high}");
    }
}

/// Checks that two logs have equal findings, up to the rounding of angles with different origins.
fn assert_equal_findings(found: &Value, truth: &Value) {
    let [found, truth] = [found, truth].map(|findings| findings.as_array().expect("a list"));
    assert_eq!(found.len(), truth.len());
    for (found, truth) in found.iter().zip(truth) {
        let [value, right] = [found, truth].map(|finding| finding["value"].as_f64());
        let apart = value.zip(right).map_or(0.0, |(value, right)| (value - right).abs() / right.abs().max(1e-3));
        assert!(value.is_some() == right.is_some() && apart < 1e-3, "{found} {truth}");
    }
}

#[test]
fn register_counts_are_unwrapped() {
    let folder = folder();
    let folder = folder.path();
    let plain = rows(folder);
    write(folder, &plain);
    identify(folder, &[]).succeeded();
    let (truth, told) = findings(folder);
    assert!(!told.contains("register") && !told.contains("jump away"), "{told}");
    let register = |value: f64, bits: i32, signed: bool| {
        let (counts, least) = (f64::from(bits).exp2(), if signed { -f64::from(bits - 1).exp2() } else { 0.0 });
        (value - least).rem_euclid(counts) + least
    };
    let registers = [((14, true), (17, true)), ((16, false), (18, false)), ((16, true), (17, false))];
    for &(motor, output) in cases(&registers, 2) {
        let read =
            |row: &[f64; 4]| [row[0], register(row[1], motor.0, motor.1), register(row[2], output.0, output.1), row[3]];
        write(folder, &plain.iter().map(read).collect::<Vec<_>>());
        identify(folder, &[]).succeeded();
        let (found, told) = findings(folder);
        assert_equal_findings(&found, &truth);
        let counts = format!("`motor_counts` is read as a register that wraps after {} values", 1 << motor.0);
        assert!(told.contains(&counts), "{told}");
    }
    // Fewer counts than the set counts per turn: the message names the option with another value.
    write(folder, &plain.iter().map(|row| [row[0], row[1].rem_euclid(8192.0), row[2], row[3]]).collect::<Vec<_>>());
    identify(folder, &["--motor-bits", "14"])
        .refused(&["an encoder of 13 bits wraps by this jump, but 14 bits are set"]);
}

/// Above 1 % the log is rejected.
#[test]
fn bad_readings_up_to_one_percent_dropped() {
    let folder = folder();
    let folder = folder.path();
    let mut spoiled = rows(folder);
    let count = spoiled.len();
    for row in (100..count).step_by(400) {
        // A flipped bit, an offset, and two wrong output readings in a row.
        match row % 3 {
            0 => spoiled[row][1] += 8192.0,
            1 => spoiled[row][1] += 777.0,
            _ => (spoiled[row][2], spoiled[row + 1][2]) = (spoiled[row][2] + 65536.0, spoiled[row + 1][2] + 65536.0),
        }
    }
    write(folder, &spoiled);
    identify(folder, &[]).succeeded();
    let (found, told) = findings(folder);
    assert_contains_truth(&found);
    for what in ["readings of `motor_counts`", "readings of `output_counts`", "jump away from the motion", "left out"] {
        assert!(told.contains(what), "{what}: {told}");
    }
    (100..count).step_by(50).for_each(|row| spoiled[row][1] += 8192.0);
    write(folder, &spoiled);
    identify(folder, &[]).refused(&["readings of `motor_counts` (2.", "line 102", "up to 1 % are removed"]);
}

#[test]
fn repeated_time_stamps_resolved_or_rejected() {
    let folder = folder();
    let folder = folder.path();
    let plain = rows(folder);
    // The host stamps ten control periods of 0.1 ms at once.
    let stamp = |row: usize| (row / 10) as f64 * 1e-3;
    let log = |more: &str, cell: &dyn Fn(usize) -> String| {
        let mut log = format!("time_s,motor_counts,output_counts,motor_torque_N_m{more}\n");
        for (row, [_, motor, output, torque]) in plain.iter().enumerate() {
            writeln!(log, "{},{motor},{output},{torque}{}", stamp(row), cell(row)).expect("a string");
        }
        fs::write(folder.join("log.csv"), log).expect("written");
    };
    log("", &|_| String::new());
    identify(folder, &[]).refused(&[
        "the time does not rise in line",
        "of 54000 rows have the time of the row before, with other values",
        "--column period=NAME",
    ]);
    log(",cycle", &|row| format!(",{}", row % 65536));
    identify(folder, &["--column", "period=cycle"]).succeeded();
    assert_contains_truth(&findings(folder).0);
    log(",time_us", &|row| format!(",{}", 100 * row));
    identify(folder, &[]).succeeded();
    let (found, told) = findings(folder);
    assert_contains_truth(&found);
    assert!(told.contains("times are those of `time_us`"), "{told}");
    // Rows that were written twice.
    let twice: Vec<[f64; 4]> =
        plain.iter().enumerate().flat_map(|(row, cells)| vec![*cells; if row % 1000 == 7 { 2 } else { 1 }]).collect();
    write(folder, &twice);
    identify(folder, &[]).succeeded();
    let (found, told) = findings(folder);
    assert_contains_truth(&found);
    assert!(told.contains("rows have the time of the row before and all its values: left out"), "{told}");
}

#[test]
fn preamble_and_incomplete_rows_skipped() {
    let folder = folder();
    let folder = folder.path();
    let plain = rows(folder);
    // Two topics merged by time: rows of another device stand between those of the drive.
    let mut log = "Drive 7, firmware 2\nrate;10000\n# made on a bench\ntime_s,motor_counts,temperature,output_counts,motor_torque_N_m\n"
        .to_owned();
    for (row, [time, motor, output, torque]) in plain.iter().enumerate() {
        writeln!(log, "{time:.6},{motor},,{output},{torque}").expect("a string");
        if row % 5 == 0 {
            writeln!(log, "{:.6},,31.5,,", time + 3e-5).expect("a string");
        }
    }
    fs::write(folder.join("log.csv"), log).expect("written");
    identify(folder, &[]).succeeded();
    let (found, told) = findings(folder);
    assert_contains_truth(&found);
    assert!(told.contains("Lines 1 to 3 before the header skipped"), "{told}");
    assert!(told.contains("rows were removed because a value is missing: `motor_counts` is empty in"), "{told}");
    // The observer is fed the same rows.
    let [path, out] = ["log.csv", "replay"].map(|name| folder.join(name));
    joint(&["replay", text(&path), "q1", "--out", text(&out)]).succeeded();
    assert!(json(&out.join("record.json"))["log_notes"].to_string().contains("value is missing"));
    // Two encoders with different time stamps.
    let mut apart = "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned();
    for [time, motor, output, torque] in &plain {
        writeln!(apart, "{time:.6},{motor},,{torque}\n{:.6},,{output},", time + 5e-5).expect("a string");
    }
    fs::write(folder.join("log.csv"), apart).expect("written");
    identify(folder, &[]).refused(&["no row has all values", "`motor_counts` is empty in", "in one message"]);
}

#[test]
fn joints_of_one_log_reported_separately() {
    let folder = folder();
    let folder = folder.path();
    let mut log = "t,knee_motor,knee_output,knee_torque,hip_motor,hip_output,hip_torque\n".to_owned();
    for [time, motor, output, torque] in &rows(folder) {
        writeln!(log, "{time},{motor},{output},{torque},{motor},{output},0").expect("a string");
    }
    fs::write(folder.join("log.csv"), log).expect("written");
    let of = |name: &str| {
        format!(
            "[joints.{name}]\njoint = \"q1\"\n[joints.{name}.columns]\nmotor_counts = \"{name}_motor\"\noutput_counts = \
             \"{name}_output\"\nmotor_torque_N_m = \"{name}_torque\"\n"
        )
    };
    let map = folder.join("map.toml");
    fs::write(&map, format!("[columns]\ntime_s = \"t\"\n{}{}", of("knee"), of("hip"))).expect("written");
    // The hip stood still: the message names it, and the findings of the knee are kept.
    let ended = identify(folder, &["--map", text(&map)]);
    assert!(ended.out.contains("knee") && ended.out.contains("half-backlash"), "{}", ended.out);
    ended.refused(&["hip: ", "there is no reversal in this log"]);
    let found = json(&folder.join("out/knee/findings.json"));
    assert_contains_truth(&found["findings"]);
    assert!(!folder.join("out/hip").exists());
    identify(folder, &["--map", text(&map), "--map-joint", "knee"]).succeeded();
    identify(folder, &["--map", text(&map), "--map-joint", "toe"]).refused(&["no joint `toe`", "hip, knee"]);
}

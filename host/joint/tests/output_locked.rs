//! `joint identify --output-locked` at the command line: on logs of the f64 reference with an immovable link the
//! intervals contain the truth, and logs without the necessary information are rejected with the cause.

mod command;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use command::{Ended, folder, joint, json, text};
use host_tests::extent::cases;
use scenario::plant::{PlantName, plant};
use scenario::surroundings::train;
use serde_json::Value;

const BACKLASH: &str = "mesh.half_backlash_um";
const STIFFNESS: &str = "compliance.stiffness_N_m_per_rad";
const FRICTION: &str = "drive_train.motor_coulomb_friction_N_m";

/// Log of torque cycles on a joint with an immovable link: time, motor counts and torque, one row in `every` periods.
fn record(name: &str, changes: &[(&str, &str)], seed: u64, peak: f64, every: usize) -> Vec<(f64, i64, f64)> {
    let preset = joint_file::preset(name).expect("a preset").to_owned();
    let changes = [&[("gravity_torque_N_m", "0")], changes].concat();
    let changed =
        changes.iter().fold(preset, |text, (key, value)| joint_file::change(&text, key, value).expect("a key"));
    let mut file = joint_file::read(&changed).expect("still a joint");
    file.parameters.link_inertia = 1e7;
    let mut plant = plant(PlantName::Reference, &file.parameters, &train(&file.surroundings, seed), Vec::new(), seed)
        .expect("it can be simulated");
    let rate = f64::from(file.surroundings.control_rate);
    let mut rows = Vec::new();
    for period in 0..(5.25 * rate) as usize {
        let time = period as f64 / rate;
        // Triangles of one second.
        let phase = (time + 0.75).fract();
        let torque = peak * (4.0 * (phase - 0.5).abs() - 1.0);
        if period % every == 0 {
            rows.push((time, plant.measure().motor_counts, torque));
        }
        plant.advance(torque).expect("it can be followed");
    }
    rows
}

fn write(folder: &Path, rows: &[(f64, i64, f64)]) {
    let mut log = "time_s,motor_counts,motor_torque_N_m\n".to_owned();
    for (time, counts, torque) in rows {
        writeln!(log, "{time:.6},{counts},{torque:.6}").expect("a string");
    }
    fs::write(folder.join("log.csv"), log).expect("written");
}

fn identify(folder: &Path, name: &str, options: &[&str]) -> Ended {
    let [log, out] = ["log.csv", "out"].map(|name| folder.join(name));
    joint(&[&["identify", text(&log), "--joint", name, "--output-locked", "--out", text(&out)], options].concat())
}

fn interval(record: &Value, key: &str) -> [f64; 2] {
    let one = record["findings"].as_array().expect("a list").iter().find(|one| one["key"] == key).expect(key);
    [0, 1].map(|end| one["interval"][end].as_f64().unwrap_or_else(|| panic!("{one}")))
}

/// Changed keys of the joint; half-gap [um], stiffness [N m/rad] and motor friction [N m]; seed; periods per row.
type Case<'a> = (&'a [(&'a str, &'a str)], [f64; 3], u64, usize);

#[test]
fn locked_output_intervals_contain_truth() {
    let folder = folder();
    let folder = folder.path();
    let joints: [Case<'_>; 4] = [
        (&[], [40.0, 10.3e3, 0.03], 1, 1),
        (&[], [40.0, 10.3e3, 0.03], 2, 10),
        (&[("half_backlash_um", "25"), ("stiffness_N_m_per_rad", "8000")], [25.0, 8000.0, 0.03], 3, 1),
        (&[("half_backlash_um", "60"), ("motor_coulomb_friction_N_m", "0.06")], [60.0, 10.3e3, 0.06], 4, 5),
    ];
    for &(changes, truths, seed, every) in cases(&joints, 2) {
        write(folder, &record("q1", changes, seed, 2.0, every));
        identify(folder, "q1", &[]).succeeded();
        let record = json(&folder.join("out/findings.json"));
        // The joint's torque constant is off by 3 %, as the joint file states.
        for ((key, truth), most) in [BACKLASH, STIFFNESS, FRICTION].into_iter().zip(truths).zip([0.4, 0.4, 3.0]) {
            let [low, high] = interval(&record, key);
            assert!((low..=high).contains(&truth), "seed {seed}, {key}: {truth} is not in {low} to {high}");
            assert!(high - low < most * truth, "seed {seed}, {key}: {low} to {high} says little of {truth}");
        }
        assert!(record["assumptions"].to_string().contains("The output is held, as stated: 5 cycles"), "{record}");
        let patched = fs::read_to_string(folder.join("out/joint.toml")).expect("written");
        joint_file::read(&patched).expect("the patched file is a joint file");
    }
}

#[test]
fn uninformative_locked_logs_rejected() {
    let folder = folder();
    let folder = folder.path();
    let rows = record("q1", &[], 7, 2.0, 10);
    write(folder, &rows[..rows.len() / 2]);
    identify(folder, "q1", &[]).refused(&["too few cycles", "to and fro 2 times"]);
    write(folder, &rows.iter().map(|(time, counts, torque)| (*time, *counts, torque + 2.5)).collect::<Vec<_>>());
    identify(folder, "q1", &[]).refused(&["no reversal"]);
    write(folder, &rows.iter().map(|(time, counts, torque)| (*time, -counts, *torque)).collect::<Vec<_>>());
    identify(folder, "q1", &[]).refused(&["signs of motor and torque"]);
    // An output that moves, and an option that needs the output's encoder.
    let mut free = "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned();
    for (time, counts, torque) in &rows {
        writeln!(free, "{time},{counts},{},{torque}", counts * 8 / 6).expect("a string");
    }
    fs::write(folder.join("log.csv"), free).expect("written");
    identify(folder, "q1", &[]).refused(&["the output is not held", "clamp the output"]);
    identify(folder, "q1", &["--quasi-static"]).refused(&["cannot be used with"]);
}

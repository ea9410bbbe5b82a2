//! `joint identify --output-only` at the command line: on logs of the f64 reference without the motor's angle the
//! intervals contain the truth, and logs without the necessary information are rejected with the cause.

mod command;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use command::{Ended, folder, joint, json, text};
use host_tests::extent::cases;
use serde_json::Value;

const INERTIA: &str = "inertia of motor and link at the output";
const DRY: &str = "dry friction of motor and link at the output";
const VISCOUS: &str = "viscous friction of motor and link at the output";
const WEIGHT: &str = "weight of the link";
const LINK: &str = "inertia of the link";
const LOST_MOTION: &str = "lost motion at the output";

/// Writes a log of the recommended test without the motor's column, one row in `every`, with the torque scaled.
fn record(folder: &Path, common: &[&str], every: usize, torque: f64) {
    let log = folder.join("all.csv");
    let _ = fs::remove_file(&log);
    joint(&[&["identify", text(&log), "--simulate"], common].concat()).succeeded();
    rewrite(folder, every, torque);
}

fn rewrite(folder: &Path, every: usize, torque: f64) {
    let mut kept = "time_s,output_counts,motor_torque_N_m\n".to_owned();
    for line in fs::read_to_string(folder.join("all.csv")).expect("written").lines().skip(1).step_by(every) {
        let cells: Vec<&str> = line.split(',').collect();
        let logged = torque * cells[3].parse::<f64>().expect("a torque");
        writeln!(kept, "{},{},{logged}", cells[0], cells[2]).expect("a string");
    }
    fs::write(folder.join("log.csv"), kept).expect("written");
}

fn identify(folder: &Path, options: &[&str]) -> Ended {
    let [log, out] = ["log.csv", "out"].map(|name| folder.join(name));
    joint(&[&["identify", text(&log), "--output-only", "--out", text(&out)], options].concat())
}

fn interval(record: &Value, name: &str) -> [f64; 2] {
    let one = record["findings"].as_array().expect("a list").iter().find(|one| one["name"] == name).expect(name);
    [0, 1].map(|end| one["interval"][end].as_f64().unwrap_or_else(|| panic!("{one}")))
}

/// Joint, bits of the output encoder, seed, samples per row, changed keys; true values by the name of the finding.
type Case<'a> = (&'a str, &'a str, &'a str, usize, &'a [&'a str], &'a [(&'a str, f64)]);

#[test]
fn output_only_intervals_contain_truth() {
    let folder = folder();
    let folder = folder.path();
    let joints: [Case<'_>; 5] = [
        (
            "q1",
            "14",
            "1",
            1,
            &[
                "link_inertia_kg_m2=0.20",
                "load_coulomb_friction_N_m=0.6",
                "gravity_torque_N_m=4",
                "half_backlash_um=70",
            ],
            &[(LINK, 0.20), (DRY, 0.78), (WEIGHT, 4.0), (VISCOUS, 0.1072), (LOST_MOTION, 6.62)],
        ),
        (
            "d2",
            "12",
            "2",
            1,
            &["load_viscous_friction_N_m_s_per_rad=0.6"],
            &[(LINK, 0.6), (DRY, 1.52), (WEIGHT, 25.0), (VISCOUS, 0.6648), (LOST_MOTION, 2.04)],
        ),
        ("c1", "14", "3", 1, &[], &[(LINK, 0.8), (DRY, 4.95), (WEIGHT, 15.0), (VISCOUS, 1.5443), (LOST_MOTION, 0.873)]),
        ("s1", "14", "4", 2, &["link_inertia_kg_m2=0.03"], &[(LINK, 0.03), (DRY, 0.4), (LOST_MOTION, 0.873)]),
        // Like a hobby servo: 250:1, most of the inertia in the rotor, 1000 samples a second of 12 bits.
        ("c1", "12", "5", 10, SERVO, &[(INERTIA, 0.05125), (DRY, 0.14), (WEIGHT, 0.3), (VISCOUS, 0.02125)]),
    ];
    for &(name, bits, seed, every, changes, truths) in cases(&joints, 2) {
        let sets: Vec<&str> = changes.iter().flat_map(|change| ["--set", *change]).collect();
        let common = ["--joint", name, "--output-bits", bits];
        record(folder, &[&common[..], &["--seed", seed], &sets].concat(), every, 1.0);
        // The servo is identified with its data sheet, the others with a joint file that lacks the changes.
        let known = if changes == SERVO { sets } else { Vec::new() };
        identify(folder, &[&common[..], &known].concat()).succeeded();
        let record = json(&folder.join("out/findings.json"));
        for (finding, truth) in truths {
            let [low, high] = interval(&record, finding);
            assert!((low..=high).contains(truth), "{name}, seed {seed}, {finding}: {truth} is not in {low} to {high}");
            let most = if *finding == LOST_MOTION { 30.0 } else { 0.7 };
            assert!(
                high - low < most * truth,
                "{name}, seed {seed}, {finding}: {low} to {high} says little of {truth}"
            );
        }
        let patched = fs::read_to_string(folder.join("out/joint.toml")).expect("written");
        joint_file::read(&patched).expect("the patched file is a joint file");
        assert!(patched.contains("identified from log.csv"), "{patched}");
    }
}

const SERVO: &[&str] = &[
    "equivalent_gear.ratio=250",
    "equivalent_gear.lost_motion_arcmin=30",
    "equivalent_gear.total_stiffness_N_m_per_arcmin=0.2",
    "bodies.gear_inertia_at_input_kg_cm2=0.001",
    "bodies.rotor_inertia_kg_m2=4e-7",
    "bodies.link_inertia_kg_m2=0.02",
    "rated_output_torque_N_m=5",
    "motor_torque_limit_N_m=0.024",
    "motor_coulomb_friction_N_m=5e-4",
    "motor_viscous_friction_N_m_s_per_rad=3.2e-7",
    "cogging_torque_N_m=0",
    "load_coulomb_friction_N_m=0.015",
    "load_viscous_friction_N_m_s_per_rad=0.00125",
    "gravity_torque_N_m=0.3",
];

#[test]
fn uninformative_output_logs_rejected() {
    let folder = folder();
    let folder = folder.path();
    record(folder, &["--joint", "q1", "--seed", "6"], 10, 1.0);
    let [log, out] = ["log.csv", "out"].map(|name| folder.join(name));
    joint(&["identify", text(&log), "--joint", "q1", "--out", text(&out)])
        .refused(&["no column for the motor", "--output-only"]);
    identify(folder, &["--output-locked"]).refused(&["cannot be used with"]);
    rewrite(folder, 10, -1.0);
    identify(folder, &[]).refused(&["different signs"]);
    rewrite(folder, 10, 0.001);
    identify(folder, &[]).refused(&["the motor alone has", "unit of the torque"]);
    let rows = fs::read_to_string(&log).expect("written");
    fs::write(&log, rows.lines().take(1200).collect::<Vec<_>>().join("\n")).expect("written");
    identify(folder, &[]).refused(&["too few reversals", "three strengths"]);
}

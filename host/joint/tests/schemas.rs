//! JSON output of the commands is valid by the published schemas.

mod command;

use std::fs;

use published_schema::assert_valid;
use serde_json::Value;

use command::{QUICK_ROWS, folder, joint, json, text, write_short_log};

#[test]
fn output_valid_by_published_schemas() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let written = |line: &[&str], name: &str| -> Value {
        let out = path(name);
        joint(&[line, &["--json", text(&out)]].concat()).succeeded();
        json(&out)
    };
    let out = |name: &str| text(&path(name)).to_owned();
    assert_valid("check.schema.json", &written(&["check", "q1"], "check.json"));
    assert_valid("budget.schema.json", &written(&["budget", "q1"], "budget.json"));
    let line = ["sim", "l1", "--duration", "0.02", "--out", &out("sim")];
    assert_valid("sim.schema.json", &written(&line, "sim.json"));
    joint(&["sweep", "q1", "--vary", "half_backlash_um=10,20", "--duration", "0.01", "--out", &out("sweep")])
        .succeeded();
    assert_valid("sweep.schema.json", &json(&path("sweep/sweep.json")));

    let log = out("log.csv");
    write_short_log(&path("log.csv"), QUICK_ROWS);
    let line = ["identify", &log, "--out", &out("identified")];
    assert_valid("identify.schema.json", &written(&line, "identify.json"));
    let line = ["replay", &log, "q1", "--out", &out("replayed")];
    assert_valid("replay.schema.json", &written(&line, "replay.json"));
    let row = |sample: i32| {
        let (sweep, place) = (sample / 100 % 2, sample % 100);
        let motor = 20 * if sweep == 0 { place } else { 100 - place };
        format!("{sample},{motor},{}\n", motor + 100 * sweep)
    };
    let sweeps = "time_s,motor_counts,output_counts\n".to_owned() + &(0..600).map(row).collect::<String>();
    fs::write(path("sweeps.csv"), sweeps).expect("room");
    let line = ["identify", &out("sweeps.csv"), "--quasi-static", "--out", &out("slow")];
    assert_valid("identify-quasi-static.schema.json", &written(&line, "slow.json"));

    // A run writes a memory and a log for `replay`.
    fs::write(path("test.toml"), "duration_s = 1\nsettle_s = 0.5\nprofile = \"T2\"\n[controller]\nrivals = []\n")
        .expect("room");
    let line = ["hil", &out("test.toml"), "--host", "--memory", "--seed", "1", "--out", &out("tests")];
    assert_valid("hil-tests.schema.json", &written(&line, "tests.json"));
    let stem = "tests/runs/test-seed1-preview";
    let line = ["memory", "show", &out(&format!("{stem}.memory")), "--joint", &out(&format!("{stem}.toml"))];
    assert_valid("memory.schema.json", &written(&line, "memory.json"));
    let line = ["replay", &out(&format!("{stem}.mcap")), "--out", &out("repeated")];
    let repeated = written(&line, "repeated.json");
    assert_eq!(repeated["repeats"]["every_bit"], true);
    assert_valid("replay.schema.json", &repeated);
}

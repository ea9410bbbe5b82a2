//! Lost motion measured by a client alone: it reverses the torque against the weight of the link, logs both encoders
//! and the torque, and `joint identify` finds the hidden gap in the log.

use report::workspace::workspace;

use crate::command::{folder, joint, json, text};
use crate::environment::Environment;
use crate::twin::Twin;

/// Time between two samples [s].
const PERIOD: &str = "0.0002";
/// Hidden half-backlashes [um].
const GAPS: [f64; 2] = [40.0, 70.0];
/// Half-backlash of the joint file that the fit begins with [um].
const WRONG: &str = "20";
/// Largest error of the found half-backlash [-]. Measured: 0.4 % with a moteus, 1.9 % with an ODrive.
const MAX_ERROR: f64 = 0.03;

/// Checks the gaps found in the logs of a client's script. `columns` are the arguments of `joint identify` for its
/// log, with `{}` for what the script printed.
fn finds_the_gaps(client: &str, drive: &str, lockstep_ms: &str, columns: &[&str]) {
    let environment = Environment::new(client);
    for gap in GAPS {
        let place = folder();
        let [log, file, out] = ["log.csv", "wrong.toml", "out"].map(|name| place.path().join(name));
        let q1 = joint_file::preset("q1").expect("a preset");
        let wrong = joint_file::change(q1, "mesh.half_backlash_um", WRONG).expect("a key");
        std::fs::write(&file, wrong).expect("written");
        let twin = Twin::start(drive, &["--lockstep", lockstep_ms]);
        twin.order(&format!("{{\"half_backlash_um\": {gap}}}"));
        let script = format!("{client}_lost_motion.py");
        let printed = environment.run(&script, &[twin.port(), twin.control(), PERIOD, text(&log)]);
        twin.end();
        let columns: Vec<String> = columns.iter().map(|word| word.replace("{}", printed.trim())).collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let arguments = ["identify", text(&log), "--joint", text(&file), "--out", text(&out)];
        joint(&[&arguments, columns.as_slice()].concat()).succeeded();
        let findings = json(&out.join("findings.json"));
        let all = findings["findings"].as_array().expect("a list");
        let found = all.iter().find(|finding| finding["key"] == "mesh.half_backlash_um").expect("a gap");
        let number = |value: &serde_json::Value| value.as_f64().expect("a number");
        let (value, [low, high]) = (number(&found["value"]), [0, 1].map(|end| number(&found["interval"][end])));
        println!("{client}: {value:.2} um, {low:.2} to {high:.2}, true {gap}");
        assert!((low..=high).contains(&gap), "{gap} um: {found}");
        assert!((value / gap - 1.0).abs() < MAX_ERROR, "{gap} um: {found}");
    }
}

fn map(name: &str) -> String {
    workspace().join("maps").join(name).display().to_string()
}

#[test]
#[ignore = "most of a minute: cargo test -p joint --test clients -- --ignored"]
fn moteus_client_alone_finds_the_gap() {
    finds_the_gaps("moteus", "moteus", "0.2", &["--map", &map("moteus.toml")]);
}

/// The client reads four frames for a sample, so that a frame advances the joint by a quarter of the period.
#[test]
#[ignore = "most of a minute: cargo test -p joint --test clients -- --ignored"]
fn odrive_client_alone_finds_the_gap() {
    let output = ["--column", "output_angle=output", "--unit", "output_angle=turns"];
    let columns = ["--map", &map("odrive.toml"), "--unit", "motor_torque={}*N_m"];
    finds_the_gaps("odrive", "odrive", "0.05", &[&columns[..], &output].concat());
}

//! `joint sim` at the command line: figures of the paper's joint, files, files after a crash or on a full disk, and
//! messages for bad input.

mod command;

use std::fs;
use std::path::Path;

use command::{
    contents, folder, interrupt, joint, joint_in, joint_on_a_full_disk, json, size, start, text, until, wait,
};
use host_tests::tolerance;
use mcap::MessageStream;
use mcap::read::Options;
use serde_json::Value;

/// Runs a simulation and returns its figures.
fn figures(arguments: &[&str]) -> Value {
    let folder = folder();
    let elsewhere = folder.path().join("figures-elsewhere.json");
    let all = [&["sim"], arguments, &["--out", text(folder.path()), "--json", text(&elsewhere)]].concat();
    joint(&all).succeeded();
    let value = json(&elsewhere);
    assert_eq!(value["schema"], "joint-sim/2");
    value
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn equivalent_gear_history_without_teeth() {
    let folder = folder();
    joint(&["sim", "c1", "--duration", "0.01", "--out", text(folder.path())]).succeeded();
    let history = fs::read_to_string(folder.path().join("history.csv")).expect("written");
    let head = history.lines().next().expect("a head").to_owned();
    assert!(head.contains(",motor_half_deflection_m,") && head.ends_with(",link_half_contact"), "{head}");
    let log = fs::read(folder.path().join("history.mcap")).expect("written");
    let summary = mcap::Summary::read(&log).expect("finished").expect("with a summary");
    let schemas = summary.schemas.values().map(|schema| String::from_utf8_lossy(&schema.data).into_owned());
    let schemas: String = schemas.collect();
    assert!(schemas.contains("motor_half_deflection_m") && schemas.contains("link_half_contact"), "{schemas}");
    for word in ["sun", "ring", "planet", "tooth", "teeth"] {
        let is_there = |text: &str| text.split(|letter: char| !letter.is_alphanumeric()).any(|part| part == word);
        assert!(!is_there(&head.replace('_', " ")) && !is_there(&schemas.replace('_', " ")), "{word}: {schemas}");
    }
}

/// MODEL: set P, from X = X' = 0. Peak to peak over b_c, period, non-fundamental over fundamental.
#[test]
fn paper_regimes_from_realtime_scheme() {
    for (half_backlash, peak_to_peak, period, beside) in
        [(0, 11.136, 1, 0.007), (10, 8.961, 1, 0.005), (60, 20.021, 3, 2.66)]
    {
        let set = format!("half_backlash_um={half_backlash}");
        let figures = figures(&["paper", "--set", &set, "--no-energy"]);
        let mesh = &figures["meshes"][0];
        let error = number(&mesh["deflection_peak_to_peak_m"]) / 10e-6 / peak_to_peak - 1.0;
        tolerance::SIM_PEAK_TO_PEAK.check(error);
        assert_eq!(figures["period"], period, "b = {half_backlash} um");
        tolerance::SIM_NON_FUNDAMENTAL.check(number(&figures["non_fundamental_over_fundamental"]) - beside);
    }
    let chaos = figures(&["paper", "--set", "half_backlash_um=120", "--no-energy"]);
    assert_eq!(chaos["period"], Value::Null, "chaos does not repeat");
}

/// Oracle 4: mesh force of the joint at rest T_D / (n r_bs), deflection b plus force over k.
#[test]
fn joint_at_rest_has_static_deflection() {
    let still = ["q1", "--speed", "0", "--duration", "0.4", "--drive", "2", "--set", "transmission_error_um=0"];
    let figures = figures(&[&still[..], &["--set", "stiffness_ratio=0", "--f64", "--no-energy"]].concat());
    let force = 2.0 / (3.0 * 0.5e-3 * 15.0 * 20f64.to_radians().cos());
    for mesh in figures["meshes"].as_array().expect("a list") {
        tolerance::SIM_STATIC.check(number(&mesh["peak_force_N"]) / force - 1.0);
        tolerance::SIM_STATIC.check(number(&mesh["deflection_mean_m"]) / (40e-6 + force / 1e8) - 1.0);
        assert_eq!(mesh["drive_side_share"], 1.0);
    }
}

/// Oracle 5: the energy balance of the reference closes.
#[test]
fn reference_energy_balance_closes() {
    let figures = figures(&["paper", "--scheme", "reference", "--duration", "0.01"]);
    tolerance::REFERENCE_ENERGY_BALANCE.check(number(&figures["energy"]["residual_over_dissipated"]));
}

#[test]
fn all_schemes_compared_with_reference() {
    let figures = figures(&["paper", "--set", "half_backlash_um=10", "--duration", "0.02", "--scheme", "all"]);
    let rows = figures["schemes"].as_array().expect("a table");
    let names: Vec<&str> = rows.iter().filter_map(|row| row["scheme"].as_str()).collect();
    assert_eq!(names, ["reference", "realtime", "paper", "rk4", "euler"]);
    let error = |row: usize| number(&rows[row]["errors"][0]);
    assert_eq!(error(0), 0.0);
    assert!(error(1) < error(3) && error(3) < error(4) && error(4) < error(2), "{rows:?}");
    assert_eq!(number(&rows[1]["cost_ratio"]), 1.0);
    assert!(rows.iter().all(|row| number(&row["cost_s_per_s"]) > 0.0), "{rows:?}");
}

/// An equivalent gear has no meshes, so only two schemes can step it. Under constant torques nothing swings, and no
/// scheme diverges.
#[test]
fn equivalent_gear_has_two_schemes() {
    let figures = figures(&["c1", "--profile", "reversals", "--duration", "0.6", "--scheme", "all"]);
    let rows = figures["schemes"].as_array().expect("a table");
    let names: Vec<&str> = rows.iter().filter_map(|row| row["scheme"].as_str()).collect();
    assert_eq!(names, ["reference", "realtime"]);
    assert!(number(&rows[1]["errors"][0]) < 1e-4, "{rows:?}");
    let folder = folder();
    let out = ["--duration", "0.05", "--out", text(folder.path())];
    let still = joint(&[&["sim", "c1", "--scheme", "all"], &out[..]].concat()).succeeded().out;
    assert!(still.contains("No oscillation under these torques") && !still.contains("diverged"), "{still}");
    for command in [&["sim", "c1"][..], &["sweep", "c1", "--vary", "lost_motion_arcmin=1,2"]] {
        let refused = joint(&[command, &["--scheme", "paper"]].concat());
        refused.refused(&["--scheme paper steps meshes", "equivalent gear", "--scheme reference or --scheme realtime"]);
    }
}

/// A prescribed mesh period needs 340 kHz by default; `--rate` selects a board's rate.
#[test]
fn mesh_period_sets_rate_option_overrides() {
    let figures_at = |rate: &[&str]| figures(&[&["paper", "--duration", "0.01", "--no-energy"], rate].concat());
    assert_eq!(figures_at(&[])["tick_rate_Hz"], 340_000);
    assert_eq!(figures_at(&["--rate", "20000"])["tick_rate_Hz"], 20_000);
}

/// Messages of a log, up to a cut.
fn messages(log: &[u8]) -> Vec<Vec<u8>> {
    let stream = MessageStream::new_with_options(log, Options::IgnoreEndMagic.into()).expect("a log");
    stream.map_while(Result::ok).map(|message| message.data.into_owned()).collect()
}

/// Number at an index of a message: eight bytes each after a header of four.
fn field(message: &[u8], place: usize) -> f64 {
    let at = 4 + 8 * place;
    f64::from_le_bytes(message[at..at + 8].try_into().expect("eight bytes"))
}

#[test]
fn csv_and_mcap_have_equal_history() {
    let folder = folder();
    joint(&["sim", "l1", "--duration", "0.05", "--every", "5", "--out", text(folder.path())]).succeeded();
    let csv = fs::read_to_string(folder.path().join("history.csv")).expect("written");
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 201);
    assert!(rows.iter().all(|row| row.len() == names.len() && names.len() == 12 + 4 * 6));
    let column = |name: &str| names.iter().position(|other| *other == name).expect(name);

    let log = fs::read(folder.path().join("history.mcap")).expect("written");
    let summary = mcap::Summary::read(&log).expect("finished").expect("with a summary");
    let channel = summary.channels.values().next().expect("one channel");
    let schema = channel.schema.as_ref().expect("a schema");
    assert_eq!((channel.topic.as_str(), channel.message_encoding.as_str()), ("/joint/motion", "cdr"));
    assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("joint_msgs/msg/Motion", "ros2msg"));
    assert_eq!(summary.stats.as_ref().map(|stats| stats.message_count), Some(201));
    let schema = String::from_utf8_lossy(&schema.data).into_owned();
    let fields: Vec<&str> = schema.lines().filter_map(|line| line.split_whitespace().nth(1)).collect();
    let place = |name: &str| fields.iter().position(|other| *other == name).expect(name);

    for (row, message) in rows.iter().zip(messages(&log)) {
        let number = |name: &str| row[column(name)].parse::<f64>().expect("a number");
        for name in ["time_s", "twist_rad", "gap_m", "drive_torque_Nm"] {
            assert_eq!(field(&message, place(&name.to_lowercase())), number(name), "{name}");
        }
        // The first list follows the numbers, with its length, aligned to eight bytes.
        let list = place("sun_planet_deflection_m");
        assert_eq!(message[4 + 8 * list], 3);
        assert_eq!(field(&message, list + 1), number("sun_planet_1_deflection_m"));
        assert_eq!(field(&message, list + 3), number("sun_planet_3_deflection_m"));
        let contact = row[column("ring_planet_3_contact")];
        assert!(["separated", "drive_side", "back_side"].contains(&contact), "{contact}");
        let word = [contact.as_bytes(), &[0]].concat();
        assert!(message.ends_with(&word), "the last word is that of the last planet");
    }
    assert_eq!(messages(&log).len(), 201);
}

#[test]
fn truncated_log_readable_to_cut() {
    let folder = folder();
    joint(&["sim", "l1", "--duration", "0.5", "--no-energy", "--out", text(folder.path())]).succeeded();
    let log = fs::read(folder.path().join("history.mcap")).expect("written");
    let whole = messages(&log).len();
    assert_eq!(whole, 10_001);
    let mut before = 0;
    for percent in (20..=100).step_by(5) {
        let found = messages(&log[..log.len() * percent / 100]).len();
        assert!(found >= before, "a longer rest cannot hold less");
        // At most one chunk and its share of the index are lost.
        assert!(100 * found + 1500 * 10 >= whole * (percent - 10) / 10 * 10, "{percent} %: {found} of {whole}");
        before = found;
    }
    assert_eq!(before, whole);
}

#[test]
fn killed_run_keeps_older_history() {
    let folder = folder();
    joint(&["sim", "l1", "--duration", "0.01", "--out", text(folder.path())]).succeeded();
    let older = fs::read(folder.path().join("history.mcap")).expect("written");
    let mut child =
        start(&["sim", "l1", "--duration", "60", "--every", "1", "--no-energy", "--out", text(folder.path())]);
    let partial = folder.path().join("history.partial.mcap");
    until("the log has grown", || size(&partial) > 300_000);
    child.kill().expect("it runs");
    wait(child);
    assert!(messages(&fs::read(&partial).expect("there")).len() > 300);
    assert_eq!(fs::read(folder.path().join("history.mcap")).expect("still there"), older);
}

#[test]
fn ctrl_c_finishes_partial_history() {
    let folder = folder();
    let child = start(&["sim", "l1", "--duration", "60", "--every", "1", "--no-energy", "--out", text(folder.path())]);
    let partial = folder.path().join("history.partial.mcap");
    until("the log has grown", || size(&partial) > 100_000);
    interrupt(&child);
    let ended = wait(child);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    assert!(ended.err.contains("stopped by the user at") && ended.err.contains("history.partial.csv"), "{ended:?}");
    let log = fs::read(&partial).expect("there");
    let count = mcap::Summary::read(&log).expect("finished").and_then(|summary| summary.stats).map(|s| s.message_count);
    assert_eq!(count, Some(messages(&log).len() as u64));
    assert!(!folder.path().join("history.mcap").exists());
}

#[test]
fn full_disk_keeps_older_results() {
    let folder = folder();
    joint(&["sim", "l1", "--duration", "0.01", "--out", text(folder.path())]).succeeded();
    let older = contents(folder.path());
    let ended =
        joint_on_a_full_disk(200, &["sim", "l1", "--duration", "1", "--no-energy", "--out", text(folder.path())]);
    ended.refused(&["cannot write", "history.partial", "free some space"]);
    let now = contents(folder.path());
    // The list of written files also contains attempts.
    let results = older.iter().filter(|(name, _)| name != ".written-by-joint");
    assert!(results.into_iter().all(|file| now.contains(file)), "what was there is there");
}

#[test]
fn full_disk_leaves_no_empty_history() {
    let folder = folder();
    let ended =
        joint_on_a_full_disk(0, &["sim", "l1", "--duration", "0.05", "--no-energy", "--out", text(folder.path())]);
    ended.refused(&["cannot write", "free some space"]);
    assert_eq!(contents(folder.path()), []);
}

#[test]
fn foreign_report_not_overwritten() {
    let folder = folder();
    let report = folder.path().join("report.html");
    fs::write(&report, "my thesis").expect("room");
    let run = || joint(&["sim", "l1", "--duration", "0.01", "--no-energy", "--out", text(folder.path())]);
    run().refused(&["report.html was not written by this command", "name another folder by --out DIR"]);
    assert_eq!(contents(folder.path()), [("report.html".to_owned(), b"my thesis".to_vec())]);
    fs::remove_file(&report).expect("there");
    run().succeeded();
    run().succeeded();
}

#[test]
fn diverged_run_is_reported() {
    let folder = folder();
    let fast = ["sim", "q1", "--scheme", "euler", "--rate", "6000", "--duration", "0.1"];
    let ended = joint(&[&fast[..], &["--out", text(folder.path())]].concat()).succeeded();
    assert!(ended.out.contains("DIVERGED"), "{ended:?}");
    let page = fs::read_to_string(folder.path().join("report.html")).expect("written");
    assert!(page.contains("DIVERGED"));
}

#[test]
fn report_has_no_network_or_script() {
    let folder = folder();
    joint(&["sim", "paper", "--scheme", "all", "--duration", "0.01", "--out", text(folder.path())]).succeeded();
    let page = fs::read_to_string(folder.path().join("report.html")).expect("written");
    for part in ["<script", "<link", "@import", "url(", " src=", " href=", "NaN", "not drawn"] {
        assert!(!page.contains(part), "{part}");
    }
    for part in ["Phase portrait", "Spectrum", "Balance of energy", "semi-implicit Euler", "cargo joint sim paper"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.len() < 4_000_000, "{} bytes", page.len());
}

/// Incremental encoders of 1000 and 1800 lines work with every command, and the joint follows. So do Hall sensors of 24
/// counts on the motor of a gear with a lost motion of 60 arcmin, which is 4 counts at the motor; with 3 arcmin the
/// observer's design is rejected. Without the rounding variance in the motor-side filter the gap would be wrong for 4 %
/// of the time with 64 counts.
#[test]
fn any_counts_per_turn_pass_all_commands() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let c1 = fs::read_to_string("../../joints/c1.toml").expect("a preset");
    let write = |name: &str, motor: u32, arcmin: &str| {
        let changed = c1
            .replace("bits = 17", &format!("counts_per_turn = {motor}"))
            .replace("bits = 19", "counts_per_turn = 7200")
            .replace("lost_motion_arcmin = 3.0", &format!("lost_motion_arcmin = {arcmin}"));
        fs::write(path(name), changed).expect("room");
        let test = format!(
            "joint = \"{name}\"\nseeds = 1\nduration_s = 2\nsettle_s = 1\nprofile = \"T2\"\n[controller]\n\
             rivals = [\"motor_pid\"]\n[assert]\nrms_mrad = \"<= 10\"\nfalse_alarms = \"== 0\"\n\
             gap_wrong_percent = \"<= 1\"\nrms_gain_over_pid = \">= 1.5\"\n"
        );
        fs::write(path("test.toml"), test).expect("room");
        joint(&["check", text(&path(name))]).succeeded();
        joint(&["sim", text(&path(name)), "--duration", "0.01", "--out", text(&path("sim"))]).succeeded();
    };
    let tables = |name: &str| joint(&["tables", text(&path(name)), "--out", text(&path("tables"))]);
    let test = || joint(&["hil", text(&path("test.toml")), "--host", "--out", text(&path("hil"))]);
    for (motor, arcmin) in [(4000, "3.0"), (24, "60.0"), (64, "60.0")] {
        write("joint.toml", motor, arcmin);
        test().succeeded();
        tables("joint.toml").succeeded();
    }
    write("joint.toml", 24, "3.0");
    for refused in [test(), tables("joint.toml")] {
        refused.refused(&[
            "the number of counts in a turn of the motor encoder is 24: it must be from 64 to 2^24",
            "from 24 on where a count is less than the lost motion at the motor",
        ]);
    }
}

/// A self-locking gear holds the link against a load torque with the motor off, on both plants: the link moves by at
/// most 3 mrad. Worm gear of a telescope mount; gap plus wind-up under 10 N m are 0.8 mrad.
#[test]
fn worm_gear_holds_with_motor_off() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let c1 = fs::read_to_string("../../joints/c1.toml").expect("a preset");
    let worm = c1
        .replace("efficiency = 0.85", "efficiency = 0.4")
        .replace("gravity_torque_N_m = 15.0", "gravity_torque_N_m = 0.0");
    fs::write(path("worm.toml"), worm).expect("room");
    fs::write(path("still.csv"), "time_s,position_rad,load_torque_N_m\n0,0,0\n0.2,0,20\n2,0,20\n").expect("room");
    let test = "joint = \"worm.toml\"\nseeds = 1\nduration_s = 2\nsettle_s = 0\n[profile]\nkind = \"csv\"\nfile = \"still.csv\"\n\
                [controller]\nmode = \"off\"\nrivals = []\n[assert]\npeak_mrad = \"<= 3\"\n";
    fs::write(path("worm-test.toml"), test).expect("room");
    for plant in ["core", "reference"] {
        joint(&["hil", text(&path("worm-test.toml")), "--host", "--plant", plant, "--out", text(&path(plant))])
            .succeeded();
    }
    assert!(joint(&["check", text(&path("worm.toml"))]).succeeded().out.contains("self-locking"));
}

#[test]
fn short_key_follows_kind_of_gear() {
    let folder = folder();
    let set = ["sim", "c1", "--profile", "reversals", "--duration", "0.01", "--set", "lost_motion_arcmin=2"];
    joint(&[&set[..], &["--out", text(folder.path())]].concat()).succeeded();
    let named =
        ["is a key of gears with teeth, and this joint has an equivalent gear", "equivalent_gear.lost_motion_arcmin"];
    for key in ["mesh.lost_motion_arcmin", "half_backlash_um"] {
        joint(&["sim", "c1", "--set", &format!("{key}=2")]).refused(&named);
    }
    let named = ["is a key of an equivalent gear, and this joint has gears with teeth", "mesh.lost_motion_arcmin"];
    joint(&["sim", "q1", "--set", "equivalent_gear.lost_motion_arcmin=2"]).refused(&named);
    let test = folder.path().join("test.toml");
    let narrow = "joint = \"c1\"\nseeds = 1\nduration_s = 0.5\nsettle_s = 0\nprofile = \"T2\"\n[plant]\nlost_motion_arcmin = 2\n";
    fs::write(&test, narrow).expect("a file");
    joint(&["hil", text(&test), "--host", "--out", text(&folder.path().join("hil"))]).succeeded();
}

#[test]
fn set_values_checked_like_file() {
    let refused = |set: &str, words: &[&str]| joint(&["sim", "q1", "--set", set]).refused(words);
    refused("half_backlsh_um=60", &["unknown key `half_backlsh_um`", "did you mean `half_backlash_um`?"]);
    refused("sun_planet.half_backlash_um=6000", &["must be 0, or between 0.5 and 1000, not 6000", "60 um"]);
    refused("mesh.damping_ratio=NaN", &["damping_ratio", "finite number"]);
    refused("planets=7", &["`planets` must be between 3 and 5, not 7"]);
    refused("planets=4", &["do not assemble"]);
    refused("half_backlash_um", &["sets nothing", "key=value"]);
}

#[test]
fn bad_input_names_remedy() {
    let folder = folder();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("room");
        path
    };
    joint(&["sim", "/no/such/joint.toml"]).refused(&["/no/such/joint.toml", "presets q1"]);
    joint(&["sim", text(folder.path())]).refused(&["it is a folder"]);
    joint(&["sim", text(&file("binary.toml", &[0xff, 0xfe, 0]))]).refused(&["not text"]);
    joint(&["sim", text(&file("broken.toml", b"name = \n"))]).refused(&["not TOML"]);
    joint(&["sim", "q1", "--duration", "0"]).refused(&["a run of 0 s", "--duration 1"]);
    joint(&["sim", "q1", "--duration", "-1"]).refused(&["a run of -1 s"]);
    joint(&["sim", "q1", "--duration", "NaN"]).refused(&["--duration is NaN"]);
    joint(&["sim", "q1", "--duration", "1e12"]).refused(&["ticks"]);
    joint(&["sim", "q1", "--duration", "1000", "--every", "1"]).refused(&["samples", "--every"]);
    joint(&["sim", "q1", "--settle", "5"]).refused(&["--settle 5 is not below"]);
    joint(&["sim", "q1", "--drive", "inf"]).refused(&["--drive is inf"]);
    joint_in(folder.path(), &["sim", "q1", "--rate", "500"]).refused(&["500 Hz", "--rate"]);
    joint(&["sim", "q1", "--profile", "no-such-profile"]).refused(&["no profile `no-such-profile`", "reversals"]);
    joint(&["sim", "q1", "--scheme", "verlet"]).refused(&["verlet"]);
    joint(&["sim", "q1", "--out", "/proc/nowhere"]).refused(&["/proc/nowhere", "--out DIR"]);
    let tanh = ["sim", "q1", "--scheme", "reference", "--set", "sharpness=10", "--set", "dead_zone=tanh"];
    joint(&[&tanh[..], &["--out", text(&folder.path().join("tanh"))]].concat())
        .refused(&["no tanh dead zone", "--set dead_zone=sharp"]);
    assert!(!Path::new("/proc/nowhere").exists());
}

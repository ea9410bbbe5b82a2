//! Test files of observer and compensation at the command line: messages for bad input, results on disk, repeatability,
//! and failure of a controller without output.

mod command;
#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod tutorial;

use std::fs;
use std::path::{Path, PathBuf};

use command::{Ended, folder, joint, json, text};
use host_tests::extent::{cases, is_long, short_or_long};
use link::messages::Role;
use scenario::plant::PlantName;
use scenario::suite;
use scenario::suite::Choice;
use serde_json::Value;

/// Writes a short test file with further lines at its end.
fn test_file(folder: &Path, more: &str) -> PathBuf {
    let path = folder.join("short.toml");
    let head = "title = \"short\"\nduration_s = 1.2\nsettle_s = 0.6\n";
    fs::write(&path, format!("{head}{more}\n")).expect("a file");
    path
}

fn run(folder: &Path, more: &str, options: &[&str]) -> Ended {
    let file = test_file(folder, more);
    let out = folder.join("out");
    joint(&[&["hil", text(&file), "--host", "--out", text(&out)], options].concat())
}

fn results(folder: &Path) -> Value {
    json(&folder.join("out/record.json"))
}

#[test]
fn shipped_tests_load() {
    let hil = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hil");
    let suite = suite::load(&hil, Choice::Full, PlantName::Reference).expect("a folder of tests");
    assert!(suite.not_run.is_empty(), "{:?}", suite.not_run);
    let all = suite.tests.len();
    let short = suite.tests.iter().filter(|test| !test.file.only_with_full).count();
    assert!(all > short && short > 10, "{all} tests, {short} of them short");
    if is_long() {
        let suite = suite::load(&hil, Choice::Short, PlantName::Reference).expect("a folder of tests");
        assert!(suite.not_run.is_empty() && suite.tests.len() == short, "{:?}", suite.not_run);
    }
}

/// The run without a file must contain no test that its board would reject.
#[test]
fn default_run_has_tests_of_both_roles() {
    let hil = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hil");
    for (role, plant) in [(Role::Loop, PlantName::Core), (Role::Observer, PlantName::Reference)] {
        let suite = suite::load(&hil, Choice::OnBoard(role), plant).expect("a folder of tests");
        assert!(!suite.tests.is_empty() && suite.not_run.is_empty(), "{:?}", suite.not_run);
        for test in suite.tests {
            assert!(test.file.controller.is_compensation() && !test.file.only_with_full, "{}", test.name);
            assert!(role == Role::Observer || test.file.faults.is_empty(), "{}", test.name);
        }
    }
}

#[test]
fn digest_depends_on_seed_only() {
    let digests = |seed: &str, plant: &str| {
        let folder = folder();
        run(folder.path(), "profile = \"T2\"", &["--seed", seed, "--plant", plant]).succeeded();
        let results = results(folder.path());
        let runs = results["tests"][0]["runs"].as_array().expect("runs").clone();
        assert_eq!(runs.len(), 3);
        runs.iter().map(|run| (run["digest"].clone(), run["figures"].clone())).collect::<Vec<_>>()
    };
    for plant in ["reference", "core"] {
        let first = digests("3", plant);
        assert_eq!(first, digests("3", plant));
        assert!(first.iter().zip(digests("4", plant)).all(|(one, other)| one.0 != other.0));
    }
}

#[test]
fn plants_agree_on_motion() {
    let peak = |plant: &str| {
        let folder = folder();
        let more = "profile = \"T2\"\n[controller]\nmode = \"motor_pid\"\nrivals = []";
        run(folder.path(), more, &["--plant", plant]).succeeded();
        let figures = results(folder.path())["tests"][0]["runs"][0]["figures"].clone();
        ["rms_mrad", "peak_mrad", "effort_N_m"].map(|name| figures[name].as_f64().expect("a number"))
    };
    for (reference, core) in peak("reference").into_iter().zip(peak("core")) {
        assert!((core / reference - 1.0).abs() < 0.1, "{core} against {reference}");
    }
}

/// False alarms of the compensation in a run of a test file.
fn false_alarms(name: &str, plant: &str, seed: &str) -> f64 {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hil").join(name);
    let folder = folder();
    let out = folder.path().join("out");
    joint(&["hil", text(&file), "--host", "--plant", plant, "--seed", seed, "--out", text(&out)]);
    let runs = results(folder.path())["tests"][0]["runs"].as_array().expect("runs").clone();
    let ours = runs.iter().find(|run| run["controller"] == "no_preview").expect("a run of the compensation");
    ours["figures"]["false_alarms"].as_f64().expect("a number")
}

/// Joints on which an encoder was excluded before the gap was known: the estimated half-gap was 1 um, with confidence,
/// at a true 35 um.
#[test]
fn sound_encoder_kept_with_unknown_gap() {
    for seed in cases(&["5737", "5829", "4048", "5715", "9583", "2869"], 2) {
        assert_eq!(false_alarms("never-worse.toml", "core", seed), 0.0, "false alarms with seed {seed}");
    }
}

/// Joints whose output encoder has sub-divisional errors. Treated as noise at rest, they blame no encoder.
#[test]
fn subdivisional_error_blames_no_encoder() {
    for seed in cases(&["603", "612"], 1) {
        assert_eq!(false_alarms("real-subdivision.toml", "reference", seed), 0.0, "false alarms with seed {seed}");
    }
}

/// After a first motion, a torque below friction leaves the motor within the gap while the link moves on.
#[test]
fn friction_stop_not_taken_for_contact() {
    assert_eq!(false_alarms("coarse-encoder.toml", "reference", "16"), 0.0);
}

/// A controller without output must fail, and the report must begin with the failure.
#[test]
fn idle_controller_fails_first_in_report() {
    let folder = folder();
    let more =
        "profile = \"T2\"\n[controller]\nmode = \"off\"\n[assert]\nrms_gain_over_pid = \">= 1\"\nrms_mrad = \"<= 1e9\"";
    let ended = run(folder.path(), more, &[]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.out.contains("FAILED   rms_gain_over_pid"), "{ended:?}");
    assert!(ended.out.contains("again:   cargo joint hil"), "{ended:?}");
    let results = results(folder.path());
    assert_eq!(results["schema"], "joint-hil-tests/2");
    assert_eq!(results["passed"], false);
    assert_eq!(results["tests"][0]["assertions"][1]["verdict"], "passed");
    let page = fs::read_to_string(folder.path().join("out/report.html")).expect("written");
    assert!(page.contains("What failed") && page.contains("<svg"), "no picture of the failure");
    let junit = fs::read_to_string(folder.path().join("out/junit.xml")).expect("written");
    assert!(junit.contains("tests=\"2\" failures=\"1\""), "{junit}");
    let times = |tag: &str| -> Vec<f64> {
        let lines = junit.lines().filter(|line| line.trim_start().starts_with(tag));
        lines
            .map(|line| line.split(" time=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a time"))
            .map(|time| time.parse().expect("seconds"))
            .collect()
    };
    let (cases, suite) = (times("<testcase "), times("<testsuite "));
    assert_eq!(cases.len(), 2);
    assert!(suite[0] > 0.0 && (cases.iter().sum::<f64>() - suite[0]).abs() < 2e-3, "{cases:?} of {suite:?}");
    let log = folder.path().join("out").join(results["tests"][0]["runs"][0]["log"].as_str().expect("a log"));
    let bytes = fs::read(log).expect("a log");
    let topics =
        mcap::MessageStream::new(&bytes).expect("MCAP").map(|message| message.expect("whole").channel.topic.clone());
    let topics: Vec<String> = topics.collect();
    let of = |topic: &str| topics.iter().filter(|other| *other == topic).count();
    // A thousand messages a second of the run, and one of the controller for each period.
    assert_eq!([of("/joint/trial"), of("/joint/controller"), topics.len()], [1200, 12_000, 13_200]);
}

#[test]
fn bandwidth_reported_with_limit() {
    let usual = compensation_bandwidth("profile = \"T2\"");
    assert_eq!(usual["asked"], false, "{usual}");
    let asked = compensation_bandwidth("profile = \"T2\"\n[controller]\nbandwidth_rad_per_s = 30");
    assert_eq!((&asked["asked"], &asked["used_rad_per_s"]), (&true.into(), &30.0.into()), "{asked}");
    assert_eq!(asked["widest_rad_per_s"], usual["widest_rad_per_s"]);
    let off = compensation_bandwidth("profile = \"T2\"\n[controller]\nmode = \"off\"");
    assert!(off.is_null(), "{off}");
}

/// Record of the bandwidth in the results of a test; the terminal must show the same figures.
fn compensation_bandwidth(more: &str) -> serde_json::Value {
    let folder = folder();
    let ended = run(folder.path(), more, &[]).succeeded();
    let bandwidth = results(folder.path())["tests"][0]["bandwidth"].clone();
    if let Some(limit) = bandwidth["limited_by"].as_str() {
        let [used, widest] =
            ["used_rad_per_s", "widest_rad_per_s"].map(|key| bandwidth[key].as_f64().expect("a number"));
        let asked = if bandwidth["asked"] == true { " asked" } else { "" };
        let line = format!("  bandwidth {used} rad/s{asked}, {widest} at most: {limit}\n");
        assert!(ended.out.contains(&line), "no `{line}`: {ended:?}");
    }
    bandwidth
}

#[test]
fn held_motor_called_locked() {
    let folder = folder();
    let ended = run(folder.path(), "profile = \"hysteresis\"", &[]).succeeded();
    assert!(ended.out.contains("hysteresis of joint Q1, locked"), "{ended:?}");
    let test = &results(folder.path())["tests"][0];
    assert_eq!(test["controller"], "locked");
    let ran: Vec<&str> =
        test["runs"].as_array().expect("runs").iter().filter_map(|run| run["controller"].as_str()).collect();
    assert_eq!(ran, ["locked", "output_integral"]);
}

#[test]
fn replay_command_repeats_failure() {
    let head =
        "profile = \"T2\"\nseeds = 3\n[controller]\nrivals = []\n[plant]\nhalf_backlash_um = [40, 80]\n[assert]\n";
    for (bound, with_one_seed) in [("\"<= 0\"", true), ("{ mean = \"<= 0\" }", false)] {
        let folder = folder();
        assert_eq!(run(folder.path(), &format!("{head}rms_mrad = {bound}"), &[]).code, Some(1));
        let of = |out: &str| json(&folder.path().join(out).join("record.json"))["tests"][0].clone();
        let first = of("out");
        let replay = first["replay"].as_str().expect("a command").to_owned();
        let seed = format!(" --seed {}", first["assertions"][0]["seed"]);
        assert_eq!(replay.ends_with(&seed), with_one_seed, "{replay}");
        assert_eq!(replay.contains("--seed"), with_one_seed, "{replay}");
        let again = folder.path().join("again");
        let words: Vec<&str> = replay.split(' ').skip(2).chain(["--out", text(&again)]).collect();
        assert_eq!(joint(&words).code, Some(1), "{replay}");
        assert_eq!(of("again")["assertions"][0]["figure"], first["assertions"][0]["figure"], "{replay}");
        assert_eq!(of("again")["replay"], first["replay"]);
    }
}

/// Unreadable test files must not prevent the other tests.
#[test]
fn bad_tests_in_folder_named_rest_runs() {
    let folder = folder();
    let tests = folder.path().join("tests");
    fs::create_dir(&tests).expect("a folder");
    let head = "duration_s = 0.3\nsettle_s = 0.1\nprofile = \"T2\"\n";
    let alone = "[controller]\nrivals = []\n";
    let tooth = "[[fault]]\nkind = \"broken_tooth\"\nstiffness_ratio = 0.3\n";
    let files = [
        ("a-broken.toml", "title = \n".to_owned()),
        ("b-misspelt.toml", head.replace("profile", "profil")),
        ("c-no-joint.toml", format!("joint = \"q2\"\n{head}")),
        ("d-tooth.toml", format!("{head}{tooth}")),
        ("e-good.toml", format!("{head}{alone}[assert]\nrms_mrad = \"<= 1e9\"\n")),
        ("f-motion.toml", "profile = { kind = \"csv\", file = \"none.csv\" }\n".to_owned()),
        ("g-joint.toml", joint_file::preset("s1").expect("a preset").to_owned()),
    ];
    for (name, content) in files {
        fs::write(tests.join(name), content).expect("a file");
    }
    let out = folder.path().join("out");
    let ended = joint(&["hil", text(&tests), "--host", "--out", text(&out)]);
    assert_eq!(ended.code, Some(2), "{ended:?}");
    let words = ["a-broken.toml", "b-misspelt.toml", "c-no-joint.toml", "d-tooth.toml", "f-motion.toml"];
    for word in words.into_iter().chain(["not TOML", "did you mean `profile`?", "presets", "--plant reference"]) {
        assert!(ended.out.contains(word), "{word}: {ended:?}");
    }
    assert!(ended.out.contains("ok       rms_mrad") && !ended.out.contains("g-joint.toml"), "{ended:?}");
    assert!(ended.err.contains("5 of 6 tests were not run"), "{ended:?}");
    let record = json(&out.join("record.json"));
    assert_eq!((record["passed"].clone(), record["tests"][0]["passed"].clone()), (false.into(), true.into()));
    let not_run = record["not_run"].as_array().expect("a list");
    assert!(
        not_run.len() == 5 && not_run.iter().all(|one| one["why"].is_string() && one["mend"].is_string()),
        "{not_run:?}"
    );
    let junit = fs::read_to_string(out.join("junit.xml")).expect("written");
    let all = junit.lines().find(|line| line.contains("<testsuites")).expect("all suites");
    assert!(
        all.contains("tests=\"6\" failures=\"0\" errors=\"0\" time="),
        "{all}: what was skipped is told of each suite"
    );
    assert_eq!(junit.matches("skipped=\"1\"").count(), 5, "{junit}");
    assert_eq!(junit.matches("<skipped type=\"not run\" message=").count(), 5, "{junit}");
    let page = fs::read_to_string(out.join("report.html")).expect("written");
    assert!(page.contains("What was not run") && page.contains("5 TESTS NOT RUN"), "the report tells");
}

#[test]
fn failure_outranks_not_run() {
    let folder = folder();
    let tests = folder.path().join("tests");
    fs::create_dir(&tests).expect("a folder");
    let head = "duration_s = 0.3\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nrivals = []\n";
    fs::write(tests.join("a.toml"), "profile = \"T3\"\n").expect("a file");
    fs::write(tests.join("b.toml"), format!("{head}[assert]\nrms_mrad = \"<= 0\"\n")).expect("a file");
    let ended = joint(&["hil", text(&tests), "--host", "--out", text(&folder.path().join("out"))]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.err.contains("1 of 2 tests failed") && ended.err.contains("a.toml was not run"), "{ended:?}");
}

#[test]
fn timed_out_test_fails() {
    let folder = folder();
    let more = "timeout_s = 0.1\nprofile = \"T2\"\n[plant]\nhalf_backlash_um = 41";
    let file = test_file(folder.path(), more);
    let long = fs::read_to_string(&file).expect("a file").replace("1.2", "3000");
    fs::write(&file, long).expect("a file");
    let ended = joint(&["hil", text(&file), "--host", "--out", text(&folder.path().join("out"))]);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.out.contains("time on the clock"), "{ended:?}");
}

#[test]
fn test_file_errors_name_remedy() {
    let refused = |more: &str, words: &[&str]| run(folder().path(), more, &[]).refused(words);
    refused("profile = \"T3\"", &["\"T3\" is not a valid kind", "did you mean"]);
    refused("profil = \"T2\"", &["unknown key `profil`", "did you mean `profile`?", "`profile` is missing"]);
    refused("half_backlash_um = 60\nprofile = \"T2\"", &["[known] or in [plant]"]);
    refused("profile = \"T2\"\n[plant]\nhalf_backlsh_um = 60", &["did you mean `half_backlash_um`?"]);
    refused("profile = \"T2\"\n[plant]\nhalf_backlash_um = [20, 6000]", &["half_backlash_um", "between 0.5 and 1000"]);
    refused("profile = \"T2\"\n[plant]\noutput_encoder.bits = 14", &["write it in [known]"]);
    refused("profile = \"T2\"\n[assert]\nrms_gian_over_pid = \">= 8\"", &["did you mean `rms_gain_over_pid`?"]);
    refused(
        "profile = \"T2\"\n[assert]\nrms_gain_over_pdi = \">= 8\"",
        &["`pdi` does not run in this test", "motor_pid"],
    );
    refused("profile = \"T2\"\n[assert]\nrms_mrad = \"8\"", &["not a bound"]);
    refused("profile = \"T2\"\n[assert]\ndeviation_rms_mrad = \"<= 8\"", &["is for impedances"]);
    refused("profile = \"T2\"\n[[fault]]\nkind = \"encoder_frozen\"\nshare = 0.1", &["`share` has no effect"]);
    refused("profile = \"T2\"\n[[fault]]\nkind = \"lost_frames\"\nstart_s = 2", &["`share` is missing"]);
    refused("joint = \"q2\"\nprofile = \"T2\"", &["q2", "presets"]);
    refused("profile = \"T2\"\n[controller]\nrivals = [\"motor_side\"]", &["motor_side cannot run beside this"]);
    refused("profile = { kind = \"csv\", file = \"none.csv\" }", &["cannot read the motion", "none.csv"]);
    for (seconds, words) in [("1e7", "the recording lasts 1"), ("1e300", "line 3: time_s is 1")] {
        let folder = folder();
        let [motion, test] = ["long.csv", "long.toml"].map(|name| folder.path().join(name));
        fs::write(motion, format!("time_s,position_rad\n0,0\n{seconds},1\n")).expect("a file");
        fs::write(&test, "profile = { kind = \"csv\", file = \"long.csv\" }\n").expect("a file");
        joint(&["hil", text(&test), "--host", "--out", text(folder.path())]).refused(&[words, "check the unit"]);
    }
    refused("profile = \"T2\"\n[assert]\nrms_mrad = \"<= 8\"\n[controller]\nshort_run = \"loop\"", &["short_run"]);
    refused("short_run = \"plant\"\nprofile = \"T2\"", &["observer", "loop"]);
    refused("settle_s = 1", &["not TOML"]);
    let many = ["`seeds`: 1000000000 seeds are too many, at most 10000 are possible", "as in 5"];
    refused("profile = \"T2\"\nseeds = 1000000000", &many);
    refused("profile = \"T2\"\nseeds = -1", &["`seeds` names no seeds", "as in 5"]);
    refused(
        "profile = \"T2\"\n[[fault]]\nkind = \"torque_bias\"\ntorque_N_m = nan",
        &["`torque_N_m` must be a number"],
    );
    refused("profile = \"T2\"\n[controller]\nmode = \"motor_pid\"\nfrom_memory = true", &["motor_pid does not learn"]);
    let late = "profile = \"T2\"\n[[fault]]\nkind = \"encoder_frozen\"\nstart_s = 1.2";
    refused(late, &["this begins when the run is over, at 1.2 s", "duration_s"]);
    refused("profile = \"T2\"\nseeds = [3, 4, 3]", &["3 is named twice"]);
    refused("profile = \"T2\"\n[controller]\nrivals = [\"motor_pid\", \"motor_pid\"]", &["motor_pid is named twice"]);
    refused("profile = \"T2\"\n[plant]\nhalf_backlash_um = \"60\"", &["\"60\" is a text", "without quotes"]);
    refused("profile = \"T2\"\n[assert]\nrms_mrad = {}", &["`rms_mrad` has no bound"]);
    let saturated = "profile = \"T2\"\n[[fault]]\nkind = \"torque_saturation\"\ntorque_N_m = -1";
    refused(saturated, &["the torque limit of -1 N m is negative"]);
    refused("profile = \"T2\"\ntitle = \"once more\"", &["duplicate key", "leave one of the two out"]);
    for seed in ["-1", "1.5", "18446744073709551616"] {
        run(folder().path(), "profile = \"T2\"", &["--seed", seed]).refused(&["a seed is a whole number from 0 to"]);
    }
    run(folder().path(), "profile = \"T2\"", &["--seed", "9-8"]).refused(&["the range of seeds 9-8 is empty"]);
    run(folder().path(), "profile = \"T2\"", &["--seed", "1-10001"]).refused(&["at most 10000 seeds are possible"]);
    for bound in ["{ all_but_percent = 5 }", "{ bound = \"<= 1\", all_but_percent = 100 }"] {
        let wanted = ["takes a bound and a part of the seeds in percent", "all_but_percent = 0.5"];
        refused(&format!("profile = \"T2\"\n[assert]\nrms_mrad = {bound}"), &wanted);
    }
}

#[test]
fn joint_and_test_arguments_not_mixed() {
    let folder = folder();
    let file = test_file(folder.path(), "profile = \"T2\"");
    joint(&["hil", text(&file), "--host", "--role", "loop"]).refused(&["--host", "--role"]);
    joint(&["hil", text(&file), "--role", "loop", "--plant", "reference"]).refused(&["does not run on a board"]);
    joint(&["hil", "q1", "--role", "loop"]).refused(&["--role is for test files"]);
    let of_joints: [&[&str]; 7] = [
        &["--duration", "3"],
        &["--profile", "reversals"],
        &["--rate", "20000"],
        &["--decimation", "20"],
        &["--picture", "a.svg"],
        &["--no-reference"],
        &["--check"],
    ];
    for option in of_joints {
        let refused = format!("{} is for joints", option[0]);
        joint(&[&["hil", text(&file)], option].concat()).refused(&[&refused, "help:"]);
    }
    joint(&["hil", text(&file), "--host", "--mode", "lockstep"]).refused(&["--mode is for a whole loop"]);
    joint(&["hil", text(&file), "--host", "--full", "--seed", "3"]).refused(&["--full", "--seed", "leave one"]);
    let of_tests: [&[&str]; 2] = [&["--full"], &["--junit", "a.xml"]];
    for option in of_tests {
        let refused = format!("{} is for test files", option[0]);
        joint(&[&["hil", "--port", "/dev/none"], option].concat()).refused(&[&refused]);
        joint(&[&["hil", "--check"], option].concat()).refused(&[&refused]);
    }
    joint(&["hil", "q1", "--host"]).refused(&["--host is for test files, and q1 is a joint"]);
    joint(&["hil", "none.toml", "--host"]).refused(&["cannot read the test file none.toml"]);
    joint(&["hil", text(folder.path()), "--host", "--json", "/none/x.json"]).refused(&["no folder /none"]);
}

#[test]
fn recorded_motion_runs_on_presets() {
    let folder = folder();
    let rows: String =
        (0..=150).map(|k| format!("{},{}\n", 0.01 * f64::from(k), 0.1 * (0.05 * f64::from(k)).sin())).collect();
    fs::write(folder.path().join("motion.csv"), format!("time_s,position_rad\n{rows}")).expect("a file");
    for preset in ["s1", "l1", "d2"] {
        let more = format!("joint = \"{preset}\"\nprofile = {{ kind = \"csv\", file = \"motion.csv\" }}");
        run(folder.path(), &more, &["--plant", "reference"]).succeeded();
    }
}

/// The memory must not change the rivals' runs.
#[test]
fn run_from_memory_knows_width_at_once() {
    let of = |from_memory: bool| {
        let folder = folder();
        let more = format!("profile = \"T2\"\n[controller]\nfrom_memory = {from_memory}");
        run(folder.path(), &more, &["--seed", "4"]).succeeded();
        let runs = results(folder.path())["tests"][0]["runs"].clone();
        let figure = |name: &str| runs[0]["figures"][name].as_f64().expect("a figure");
        (figure("width_right_after_s"), runs[1]["digest"].clone())
    };
    let ((fresh, rival), (remembered, same)) = (of(false), of(true));
    assert!(fresh > 0.1 && remembered < 0.01, "{fresh} s, then {remembered} s");
    assert_eq!(rival, same, "a rival learns nothing");
}

#[test]
fn documented_example_passes() {
    let document = include_str!("../../../docs/reference/hil-file.md");
    let (_, rest) = document.split_once("```toml\n").expect("an example");
    let (example, _) = rest.split_once("```").expect("its end");
    let seeds = "\nseeds = 5\n";
    assert!(example.contains(seeds), "the example has five seeds");
    let example = example.replace(seeds, short_or_long("\nseeds = 1\n", seeds));
    let folder = folder();
    let file = folder.path().join("example.toml");
    fs::write(&file, example).expect("a file");
    joint(&["hil", text(&file), "--host", "--plant", "reference", "--out", text(folder.path())]).succeeded();
}

#[test]
fn tutorial_matches_output() {
    tutorial::follow_page("tutorial.md", tutorial::Tier::Host);
}

#[test]
fn quick_start_matches_output() {
    tutorial::follow_page("quick-start.md", tutorial::Tier::Host);
}

#[test]
fn wrong_page_line_is_located_and_updated() {
    let right = "`a/b.toml`:\n\n```toml\nmass_kg = 3\nlength_m = 1\n```\n\n```console\n$ cat a/b.toml; echo took 7 s\n...\nlength_m = 1\n\
                 took [...] s\n$ false\n$ echo $?\n1\n```\n";
    let followed = |page: &str| tutorial::follow(page, tutorial::Tier::Host);
    assert!(followed(right).differences.is_empty(), "{:?}", followed(right));
    let wrong = right.replace("...\nlength_m = 1", "...\nlength_m = 2");
    let found = followed(&wrong);
    let [difference] = &found.differences[..] else { panic!("{found:?}") };
    assert!(difference.contains("    11 - length_m = 2\n       + length_m = 1\n"), "{difference}");
    assert_eq!((found.commands, found.page), (3, right.to_owned()));
    let silent = right.replace("$ echo $?\n1\n", "");
    assert!(followed(&silent).differences[0].contains("line 13: `false` ends with 1"), "{:?}", followed(&silent));
    let missing = right.replace("took [...] s\n", "");
    assert!(followed(&missing).page.contains("length_m = 1\ntook 7 s\n"), "{:?}", followed(&missing));
}

/// Files of an output folder: the record without dates and times on the clock, logs, memories.
fn lasting(out: &Path) -> Vec<(String, Vec<u8>)> {
    let mut record = json(&out.join("record.json"));
    let parts = |record: &mut Value| ["date", "seconds"].map(|key| record.as_object_mut().expect("a map").remove(key));
    parts(&mut record);
    record["tests"].as_array_mut().expect("tests").iter_mut().for_each(|test| {
        parts(test);
    });
    let mut files = command::contents(&out.join("runs"));
    files.push(("record.json".to_owned(), record.to_string().into_bytes()));
    files
}

/// Seeds run as tasks give the record, the logs and the memories of one process, and no task runs twice.
#[test]
fn tasks_give_record_of_one_process() {
    let folder = folder();
    let file = test_file(folder.path(), "profile = \"T2\"\n[controller]\nrivals = [\"motor_pid\"]");
    let [one, other] = ["one", "other"].map(|name| folder.path().join(name));
    let hil = |out: &Path, options: &[&str]| {
        joint(&[&["hil", text(&file), "--host", "--seed", "1-3", "--memory", "--out", text(out)], options].concat())
    };
    hil(&one, &[]).succeeded();
    let ended = hil(&other, &["--slurm"]).succeeded();
    assert!(ended.out.contains("3 tasks are left") && ended.out.contains("--resume"), "{ended:?}");
    assert!(!other.join("record.json").exists());
    // The list is enough to run a task elsewhere.
    let place = folder.path().join("elsewhere");
    fs::create_dir(&place).expect("room");
    fs::copy(other.join("tasks/list.json"), place.join("list.json")).expect("room");
    let names = |place: &Path| command::contents(place).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    for number in ["0", "2"] {
        joint(&["task", text(&place), "--number", number]).succeeded();
    }
    let results: Vec<String> = names(&place).into_iter().filter(|name| name.ends_with(".result")).collect();
    assert_eq!(results.len(), 2, "{results:?}");
    for name in results {
        fs::copy(place.join(&name), other.join("tasks").join(&name)).expect("room");
    }
    let ended = hil(&other, &["--resume"]).succeeded();
    assert!(ended.err.contains("continuing: 2 of 3 tasks"), "{ended:?}");
    assert_eq!(lasting(&other), lasting(&one));
    let ended = hil(&other, &["--resume"]).succeeded();
    assert!(ended.err.contains("continuing: 3 of 3 tasks"), "{ended:?}");
    assert_eq!(lasting(&other), lasting(&one));
}

#[test]
fn tasks_without_host_rejected() {
    let folder = folder();
    let file = test_file(folder.path(), "profile = \"T2\"");
    let hil = |options: &[&str]| joint(&[&["hil", text(&file)], options].concat());
    hil(&["--resume"]).refused(&["--resume runs tests as tasks, which have no board", "--host"]);
    hil(&["--slurm"]).refused(&["--slurm runs tests as tasks", "--host"]);
    hil(&["--host", "--resume", "--live"]).refused(&["a live view", "leave one of them out"]);
    joint(&["hil", "q1", "--dask", "tcp://127.0.0.1:1"]).refused(&["--dask is for test files"]);
}

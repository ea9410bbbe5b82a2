//! `joint identify --quasi-static` at the command line: on logs with a known truth the intervals contain it, and logs
//! without the necessary information are rejected with the cause.

mod command;

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use command::{Ended, folder, joint, json, text};
use host_tests::extent::short_or_long;
use scenario::random::RandomStream;
use serde_json::Value;

/// Units per turn of the output, in the log format of the measured joint.
const TURN: f64 = 4096.0 * 220.0 / 360.0;

/// A joint in slow sweeps, and the recording.
#[derive(Clone, Copy)]
struct Sweeps {
    seed: u64,
    /// Sampling rate [Hz].
    rate: f64,
    /// Duration of a sweep [s].
    sweep: f64,
    /// Phase of the first sample within a sweep.
    phase: f64,
    /// Sweeps in each half.
    count: usize,
    /// Mean lost motion, or width by direction, and its amplitude over the position [units].
    width: [f64; 2],
    /// Hysteresis in each half [units].
    hysteresis: [f64; 2],
    /// Scatter of passes and of single readings [units].
    scatter: [f64; 2],
    /// Sign of the load in each half.
    loads: [f64; 2],
}

const SWEEPS: Sweeps = Sweeps {
    seed: 1,
    rate: 333.0,
    sweep: 6.0,
    phase: 0.0,
    count: 8,
    width: [20.0, 4.0],
    hysteresis: [4.0, 7.0],
    scatter: [0.4, 0.3],
    loads: [1.0, -1.0],
};

/// Sample: time, output, motor on the output's scale, direction, load.
#[derive(Clone, Copy)]
struct Sample {
    time: f64,
    output: f64,
    motor: f64,
    way: f64,
    load: f64,
}

const LOW: f64 = 1000.0;
const TRAVEL: f64 = 1200.0;
const LONG_WAVE: f64 = 15.0;
const RIPPLE: f64 = 2.0;
const RIPPLE_PERIOD: f64 = 50.0;

fn map(place: f64) -> f64 {
    LONG_WAVE * (TAU * (place - LOW) / TRAVEL).cos() + RIPPLE * (TAU * place / RIPPLE_PERIOD).sin()
}

impl Sweeps {
    fn width_at(&self, place: f64) -> f64 {
        self.width[0] + self.width[1] * (1.5 * TAU * (place - LOW) / TRAVEL).sin()
    }

    /// Two halves with a rest between them. The load closes one flank throughout a half; without load, friction closes
    /// the flank of the direction.
    fn record(&self) -> Vec<Sample> {
        let mut random = RandomStream::new(self.seed, "sweeps");
        let half = self.sweep * self.count as f64;
        let rest = self.sweep;
        let total = 2.0 * half + rest;
        let mut samples = Vec::new();
        let (mut before, mut play, mut last_pass, mut offset) = (LOW + TRAVEL * self.phase, 0.0_f64, usize::MAX, 0.0);
        for step in 0..(total * self.rate) as usize {
            let time = step as f64 / self.rate;
            let moving = if time < half { time } else { (time - rest).max(half) };
            let index = usize::from(time >= half + 0.5 * rest);
            let sweeps = moving / self.sweep + self.phase;
            let pass = 2 * sweeps as usize + index;
            if pass != last_pass {
                (last_pass, offset) = (pass, self.scatter[0] * random.normal());
            }
            let share = sweeps.rem_euclid(2.0);
            let motor = LOW + TRAVEL * if share < 1.0 { share } else { 2.0 - share };
            let load = self.loads[index];
            let reach = 0.5 * if load == 0.0 { self.width_at(motor) } else { self.hysteresis[index] };
            play = (play + motor - before).clamp(-reach, reach);
            let mut output = motor;
            for _ in 0..6 {
                output = motor + map(output) - play - 0.5 * load * self.width_at(output);
            }
            let way = (motor - before).signum();
            before = motor;
            let read = output + offset + self.scatter[1] * random.normal();
            samples.push(Sample { time, output: read, motor, way, load });
        }
        samples
    }

    /// Log in the format of the measured joint: no header, blanks, output minus motor with an offset.
    fn as_measured(&self) -> String {
        let row = |one: &Sample| {
            let difference = one.output - one.motor + 2000.0;
            format!("{:.18e} {:.18e} {difference:.18e}\n", one.time, one.output)
        };
        self.record().iter().map(row).collect()
    }

    /// The halves as options.
    fn halves(&self) -> [String; 2] {
        let (half, rest) = (self.sweep * self.count as f64, self.sweep);
        [format!("0..{half}"), format!("{}..{}", half + rest, 2.0 * half + rest)]
    }
}

const MEASURED: [&str; 7] =
    ["--quasi-static", "--column", "time_s=1", "--column", "output_counts=2", "--column", "output_less_motor_counts=3"];

/// Runs the command on a log.
fn identify(folder: &Path, log: &str, options: &[&str]) -> Ended {
    let [path, out] = ["log.txt", "out"].map(|name| folder.join(name));
    fs::write(&path, log).expect("room");
    joint(&[&["identify", text(&path), "--out", text(&out)], options].concat())
}

fn findings(log: &str, options: &[&str]) -> Value {
    let folder = folder();
    identify(folder.path(), log, options).succeeded();
    json(&folder.path().join("out/findings.json"))
}

/// Value and interval of a figure.
fn found(record: &Value, key: &str) -> (f64, [f64; 2]) {
    let all = record["quantities"].as_array().expect("a list");
    let one = all.iter().find(|one| one["key"] == key).unwrap_or_else(|| panic!("no {key}"));
    let value = one["value"].as_f64().unwrap_or_else(|| panic!("no value of {key}"));
    let ends = [0, 1].map(|end| one["interval"][end].as_f64().unwrap_or(f64::NAN));
    (value, ends)
}

fn near(record: &Value, key: &str, truth: f64, share: f64) {
    let (value, _) = found(record, key);
    assert!((value / truth - 1.0).abs() < share, "{key}: {value}, truly {truth}");
}

/// True lost motion at a quantile of the positions that the record kept.
fn true_width(sweeps: &Sweeps, record: &Value, share: f64) -> f64 {
    let places = record["place"].as_array().expect("places").iter().filter_map(Value::as_f64);
    let mut widths: Vec<f64> = places.map(|place| sweeps.width_at(place)).collect();
    widths.sort_by(f64::total_cmp);
    let place = share * (widths.len() - 1) as f64;
    let (below, part) = (widths[place as usize], place.fract());
    below + part * (widths[(place as usize + 1).min(widths.len() - 1)] - below)
}

#[test]
fn measured_format_read_by_one_command() {
    let folder = folder();
    let [first, second] = SWEEPS.halves();
    let turn = TURN.to_string();
    let options = [&MEASURED[..], &["--half", &first, "--half", &second, "--output-units-per-turn", &turn]].concat();
    let said = identify(folder.path(), &SWEEPS.as_measured(), &options).succeeded().out;
    assert!(said.contains("lost motion, median over the places") && said.contains("hysteresis, second half"), "{said}");
    let out = folder.path().join("out");
    let page = fs::read_to_string(out.join("report.html")).expect("written");
    assert!(page.contains("<svg") && page.contains("lost motion"), "a page with pictures");
    for picture in ["lost-motion.svg", "difference.svg", "error-map.svg", "left-over.svg", "passes.svg"] {
        assert!(fs::read_to_string(out.join(picture)).expect("written").starts_with("<svg"), "{picture}");
    }
    let record = json(&out.join("findings.json"));
    assert_eq!(record["schema"], "joint-identify-quasi-static/1");
    assert_eq!(record["passes"].as_array().expect("a list").len(), 16);
    for (key, share) in [("lost_motion_median", 0.5), ("lost_motion_10_percent", 0.1), ("lost_motion_90_percent", 0.9)]
    {
        near(&record, key, true_width(&SWEEPS, &record, share), 0.05);
    }
    near(&record, "hysteresis_1", 4.0, 0.15);
    near(&record, "hysteresis_2", 7.0, 0.15);
    near(&record, "map_long_wave_range", 2.0 * LONG_WAVE, 0.05);
    near(&record, "map_ripple_rms", RIPPLE / 2f64.sqrt(), 0.1);
    near(&record, "repeatability_of_whole_passes", 0.4, 0.5);
    near(&record, "output_per_motor", 1.0, 0.01);
    let median = &record["quantities"].as_array().expect("a list")[0];
    let degrees = median["value"].as_f64().expect("a number") * 360.0 / TURN;
    assert!((median["value_deg"].as_f64().expect("a turn is known") - degrees).abs() < 1e-12);
    // Describing a width with an amplitude of 4 by its mean leaves half of the amplitude unexplained in each half.
    let left = |key: &str| record["prediction"][key].as_f64().expect("a number");
    let unexplained = (left("map_and_width").powi(2) - left("curves").powi(2)).sqrt();
    assert!((unexplained / (0.5 * 4.0 / 2f64.sqrt()) - 1.0).abs() < 0.15, "{unexplained}");
    assert!((left("curves") / left("repeatability") - 1.0).abs() < 0.4, "{}", record["prediction"]);
    assert!(left("map") > 8.0, "a width of 20 is half of it either way");
}

#[test]
fn intervals_cover_truth_in_95_percent() {
    let (mut inside, mut all) = (0, 0);
    for seed in 100..short_or_long(110, 140) {
        // Every other log has the course of the measured joint: three sweeps in each half, two of them over the same
        // positions.
        let sweeps = match seed % 2 {
            0 => Sweeps { seed, rate: 50.0, ..SWEEPS },
            _ => Sweeps { seed, rate: 50.0, phase: 0.45, count: 3, sweep: 20.0, ..SWEEPS },
        };
        let [first, second] = sweeps.halves();
        let record = findings(&sweeps.as_measured(), &[&MEASURED[..], &["--half", &first, "--half", &second]].concat());
        let truths = [
            ("lost_motion_median", true_width(&sweeps, &record, 0.5)),
            ("lost_motion_90_percent", true_width(&sweeps, &record, 0.9)),
            ("hysteresis_1", sweeps.hysteresis[0]),
            ("hysteresis_2", sweeps.hysteresis[1]),
        ];
        for (key, truth) in truths {
            let (value, [low, high]) = found(&record, key);
            all += 1;
            let most = if sweeps.count > 3 { 3.0 } else { 12.0 };
            assert!(high - low < most, "{key}: {low} to {high} says little of {truth}");
            if (low..=high).contains(&truth) {
                inside += 1;
            } else {
                println!("seed {seed}, {key}: {truth} is not in {low} to {high} about {value}");
            }
        }
        assert!(record["quantities"][0]["value_deg"].is_null(), "nobody said what a turn is");
    }
    println!("{inside} of {all} inside");
    assert!(100 * inside >= 90 * all, "{inside} of {all} true values lie in their 95 % intervals");
    // Intervals that contain every truth would be too wide to be useful.
    assert!(inside < all, "{inside} of {all}");
}

/// Log with a header, the motor's own column in counts over a gear ratio of 6, and torques.
fn with_torque(sweeps: &Sweeps, separator: &str, torque: impl Fn(&Sample) -> f64) -> String {
    let mut log =
        ["time_ms", "output_counts", "motor_counts", "motor_torque_N_m", "output_torque_N_m"].join(separator) + "\n";
    for one in sweeps.record() {
        let torque = torque(&one);
        let cells = [1e3 * one.time, one.output, 3.0 * one.motor, torque / 6.0, torque].map(|cell| cell.to_string());
        writeln!(log, "{}", cells.join(separator)).expect("a string");
    }
    log
}

/// 16384 against 8192 counts a turn, over a ratio of 6.
const GEARED: [&str; 7] =
    ["--quasi-static", "--gear-ratio", "6", "--output-units-per-turn", "16384", "--motor-units-per-turn", "8192"];

#[test]
fn ten_hertz_log_width_and_friction() {
    let slow = Sweeps { rate: 10.0, sweep: 40.0, count: 4, loads: [0.0; 2], ..SWEEPS };
    let friction = |one: &Sample| if one.way > 0.0 { 0.6 } else { -0.42 };
    for separator in [",", ";", "\t", "  "] {
        let record = findings(&with_torque(&slow, separator, friction), &GEARED);
        near(&record, "width_by_direction_median", true_width(&slow, &record, 0.5), 0.06);
        near(&record, "motor_torque_forwards", 0.1, 1e-6);
        near(&record, "motor_torque_backwards", -0.07, 1e-6);
        near(&record, "motor_torque_dry_friction", 0.085, 1e-6);
        near(&record, "output_torque_dry_friction", 0.51, 1e-6);
        near(&record, "output_torque_load_and_asymmetry", 0.09, 1e-6);
        assert!(record["assumptions"][0].as_str().expect("text").contains("reverses with the direction"), "{record}");
        let lost_motion = &record["quantities"][0];
        assert!(
            lost_motion["key"] == "lost_motion" && lost_motion["value"].is_null(),
            "hysteresis is in it: {lost_motion}"
        );
    }
}

/// Without scatter the resolution of the readings limits the interval.
#[test]
fn exact_passes_interval_is_resolution() {
    let exact = Sweeps { scatter: [0.0; 2], rate: 50.0, loads: [0.0; 2], width: [9.4, 0.0], ..SWEEPS };
    let mut log = "time_s,output_counts,motor_counts,motor_torque_N_m\n".to_owned();
    for one in exact.record() {
        let torque = (one.way * 0.333 * 20.0).round() / 20.0;
        writeln!(log, "{},{},{},{torque}", one.time, (one.output / 4.0).round(), (one.motor / 4.0).round())
            .expect("a string");
    }
    let record = findings(&log, &["--quasi-static"]);
    let resolution = 2.0;
    let (_, [low, high]) = found(&record, "width_by_direction_median");
    assert!(high - low >= 2.0 * resolution && (low..=high).contains(&(9.4 / 4.0)), "{low} to {high}");
    let (_, [low, high]) = found(&record, "motor_torque_dry_friction");
    assert!((low..=high).contains(&0.333), "{low} to {high}");
    let width = &record["width_over_place"];
    let ends = width["low"].as_array().expect("a list").iter().zip(width["high"].as_array().expect("a list"));
    for (low, high) in ends {
        assert!(high.as_f64().expect("a number") - low.as_f64().expect("a number") >= 1.999 * resolution);
    }
}

#[test]
fn multi_turn_register_unwrapped() {
    let sweeps = Sweeps { loads: [0.0; 2], rate: 50.0, ..SWEEPS };
    let log = |read: &dyn Fn(f64) -> f64, bad: usize| {
        let mut log = "time_s,output_counts,motor_counts\n".to_owned();
        for (row, one) in sweeps.record().iter().enumerate() {
            let motor = if row == bad { 7.0 } else { read((60.0 * one.motor).round()) };
            writeln!(log, "{},{},{motor}", one.time, (10.0 * one.output).round()).expect("a string");
        }
        log
    };
    let turns =
        ["--quasi-static", "--gear-ratio", "6", "--output-units-per-turn", "16384", "--motor-units-per-turn", "16384"];
    let plain = findings(&log(&|count| count, usize::MAX), &turns);
    let register = findings(&log(&|count| count.rem_euclid(65536.0), usize::MAX), &turns);
    assert_eq!(plain["quantities"], register["quantities"]);
    assert!(register["assumptions"].to_string().contains("wraps after 65536"), "{}", register["assumptions"]);
    let spoiled = findings(&log(&|count| count.rem_euclid(65536.0), 700), &turns);
    assert!(spoiled["assumptions"].to_string().contains("1 of 5100"), "{}", spoiled["assumptions"]);
    near(&spoiled, "width_by_direction_median", found(&plain, "width_by_direction_median").0, 0.01);
}

/// The remedy must not ask for an option that is already on the command line.
#[test]
fn stated_option_not_requested_again() {
    let folder = folder();
    let sweeps = Sweeps { loads: [0.0; 2], rate: 100.0, ..SWEEPS };
    let wrapped: String = std::iter::once("time_s,output_counts,motor_counts\n".to_owned())
        .chain(
            sweeps.record().iter().map(|one| format!("{},{},{}\n", one.time, one.output.rem_euclid(700.0), one.motor)),
        )
        .collect();
    let said = identify(folder.path(), &wrapped, &["--quasi-static", "--output-units-per-turn", "1500"]);
    assert!(said.err.contains("another number than the 1500 stated by --output-units-per-turn"), "{}", said.err);
    let geared = with_torque(&sweeps, ",", |one| one.way);
    let all =
        ["--quasi-static", "--gear-ratio", "9", "--output-units-per-turn", "16384", "--motor-units-per-turn", "8192"];
    let said = identify(folder.path(), &geared, &all);
    assert!(said.err.contains("one of the options that are stated is wrong"), "{}", said.err);
    assert!(!said.err.contains("state --"), "{}", said.err);
}

#[test]
fn wrong_ratio_rejected_right_one_named() {
    let folder = folder();
    let straight = |one: Sample| Sample { motor: one.motor + map(one.output), ..one };
    let slow = Sweeps { rate: 10.0, sweep: 40.0, count: 4, loads: [0.0; 2], ..SWEEPS };
    let log = |factor: f64| {
        let mut log = "time_s,output_counts,motor_counts\n".to_owned();
        for one in slow.record().into_iter().map(straight) {
            writeln!(log, "{},{},{}", one.time, one.output, 3.0 * factor * one.motor).expect("a string");
        }
        log
    };
    identify(folder.path(), &log(1.0), &GEARED).succeeded();
    identify(folder.path(), &log(1.02), &GEARED).refused(&["the output turns 0.98", "6.12", "--gear-ratio"]);
}

#[test]
fn width_without_load_is_ambiguous() {
    let slow = Sweeps { loads: [0.0; 2], rate: 100.0, ..SWEEPS };
    let record = findings(&slow.as_measured(), &MEASURED);
    near(&record, "width_by_direction_median", true_width(&slow, &record, 0.5), 0.06);
    assert!(record["assumptions"][0].as_str().expect("text").contains("The load is unknown"), "{record}");
}

#[test]
fn torque_sign_gives_load_direction() {
    let loaded = Sweeps { rate: 100.0, ..SWEEPS };
    let record = findings(&with_torque(&loaded, ",", |one| 3.0 * one.load + 0.5 * one.way), &GEARED);
    near(&record, "lost_motion_median", true_width(&loaded, &record, 0.5), 0.05);
    near(&record, "hysteresis_2", 7.0, 0.15);
    near(&record, "output_torque_dry_friction_1", 0.5, 0.01);
    // A constant load keeps one flank closed, so the log shows no lost motion.
    let one_way = Sweeps { loads: [1.0; 2], hysteresis: [5.0; 2], rate: 100.0, ..SWEEPS };
    let record = findings(&with_torque(&one_way, ",", |one| 3.0 * one.load + 0.5 * one.way), &GEARED);
    near(&record, "hysteresis_1", 5.0, 0.15);
    assert!(record["quantities"][0]["key"] == "lost_motion" && record["quantities"][0]["value"].is_null(), "{record}");
    assert!(record["assumptions"][0].as_str().expect("text").contains("one flank carries all the time"), "{record}");
}

/// Radians, a motor that counts backwards, and the other order of loads.
#[test]
fn units_and_signs_give_equal_width() {
    let sweeps = Sweeps { rate: 50.0, loads: [-1.0, 1.0], ..SWEEPS };
    let [first, second] = sweeps.halves();
    let halves = ["--half", &first, "--half", &second];
    let turn = TURN.to_string();
    let log = |output: f64, motor: f64, names: [&str; 2]| -> String {
        let mut log = format!("{} {} time_s\n", names[0], names[1]);
        for one in sweeps.record() {
            writeln!(log, "{} {} {}", output * one.output, motor * one.motor, one.time).expect("a string");
        }
        log
    };
    let radians = TAU / TURN;
    let in_radians = log(radians, -50.0 * radians, ["output_angle_rad", "motor_angle_rad"]);
    let mixed = log(1.0, -50.0 * radians, ["output_counts", "motor_angle_rad"]);
    let in_counts = log(1.0, 1.0, ["output_counts", "motor_counts"]);
    let geared = [&["--quasi-static", "--gear-ratio", "-50"], &halves[..]].concat();
    let told = ["--output-units-per-turn", &turn];
    let degrees = |log: &str, options: &[&str]| {
        let record = findings(log, options);
        assert!(
            record["quantities"][0]["note"].as_str().expect("text").contains("higher in the first half"),
            "{record}"
        );
        record["quantities"][0]["value_deg"].as_f64().expect("a turn is known")
    };
    let all = [
        degrees(&in_radians, &geared),
        degrees(&mixed, &[&geared[..], &told].concat()),
        degrees(&in_counts, &[&["--quasi-static"], &halves[..], &told].concat()),
    ];
    assert!((all[0] / (20.0 * 360.0 / TURN) - 1.0).abs() < 0.15, "{all:?}");
    assert!(all.iter().all(|one| (one / all[0] - 1.0).abs() < 1e-6), "{all:?}");
    let folder = folder();
    let refused = |log: &str, options: &[&str], words: &[&str]| identify(folder.path(), log, options).refused(words);
    refused(&mixed, &geared, &["one encoder is in radians", "state --output-units-per-turn"]);
    refused(&in_radians, &[&geared[..], &told].concat(), &["--output-units-per-turn has no effect", "leave it out"]);
}

#[test]
fn mcap_log_equals_text_log() {
    let sweeps = Sweeps { rate: 50.0, loads: [0.0; 2], count: 3, ..SWEEPS };
    let folder = folder();
    let [log, out] = ["log.mcap", "out"].map(|name| folder.path().join(name));
    let file = std::io::BufWriter::new(fs::File::create(&log).expect("room"));
    let mut writer = mcap::Writer::new(file).expect("a log");
    let mut plain = "time_s,output_counts,motor_counts\n".to_owned();
    let channel = writer.add_channel(0, "/joint", "json", &Default::default()).expect("a channel");
    for (sequence, one) in (0..).zip(sweeps.record()) {
        let Sample { time, output, motor, .. } = one;
        let log_time = (time * 1e9) as u64;
        let header = mcap::records::MessageHeader { channel_id: channel, sequence, log_time, publish_time: log_time };
        let message = format!("{{\"time_s\": {time}, \"read\": [{output}, {motor}]}}");
        writer.write_to_known_channel(&header, message.as_bytes()).expect("written");
        writeln!(plain, "{time},{output},{motor}").expect("a string");
    }
    writer.finish().expect("written");
    let columns = ["--column", "output_counts=read[0]", "--column", "motor_counts=read[1]"];
    for topic in [&[][..], &["--topic", "/joint"]] {
        let options = ["identify", text(&log), "--quasi-static", "--out", text(&out)];
        joint(&[&options[..], &columns, topic].concat()).succeeded();
        let record = json(&out.join("findings.json"));
        assert_eq!(record["quantities"], findings(&plain, &["--quasi-static"])["quantities"]);
    }
}

#[test]
fn gaps_and_jitter_noted_turns_joined() {
    let sweeps = Sweeps { rate: 100.0, ..SWEEPS };
    let mut random = RandomStream::new(7, "jitter");
    let mut log = String::new();
    for (row, one) in sweeps.record().iter().enumerate() {
        if (1300..1345).contains(&row) {
            continue;
        }
        // The output passes a turn of 700 units twice in a sweep.
        let output = one.output.rem_euclid(700.0);
        let time = one.time + 3e-3 * random.uniform();
        writeln!(log, "{time},{output},{}", output - one.motor.rem_euclid(700.0)).expect("a string");
    }
    let [first, second] = sweeps.halves();
    let record = findings(
        &log,
        &[&MEASURED[..], &["--half", &first, "--half", &second, "--output-units-per-turn", "700"]].concat(),
    );
    assert_eq!(record["gaps"], 1);
    assert!((record["longest_step_s"].as_f64().expect("a number") - 0.46).abs() < 0.01, "{}", record["longest_step_s"]);
    near(&record, "lost_motion_median", true_width(&sweeps, &record, 0.5), 0.05);
}

#[test]
fn uninformative_logs_name_cause_and_remedy() {
    let folder = folder();
    let refused = |log: &str, options: &[&str], words: [&str; 2]| {
        let ended = identify(folder.path(), log, options);
        assert_eq!(ended.code, Some(2), "{words:?}: {} {}", ended.out, ended.err);
        assert!(words.iter().all(|words| ended.err.contains(words)), "{words:?}: {}", ended.err);
        assert!(
            ended.err.contains("help:")
                || ended.err.contains("tip:")
                || ended.err.contains("Usage")
                || ended.err.contains("--help"),
            "{}",
            ended.err
        );
    };
    let quick = Sweeps { rate: 100.0, ..SWEEPS };
    let measured = quick.as_measured();
    let [first, second] = quick.halves();
    let halves = [&MEASURED[..], &["--half", &first, "--half", &second]].concat();
    let with = |more: &[&'static str]| [&MEASURED[..], more].concat();
    // Errors of the log.
    refused(&measured, &MEASURED, ["two levels", "--half"]);
    let cut = Sweeps { phase: 0.45, count: 3, sweep: 20.0, rate: 50.0, ..quick };
    refused(&cut.as_measured(), &MEASURED, ["do not repeat", "--half"]);
    refused(&measured, &["--quasi-static"], ["no header", "--column time_s=1"]);
    refused(
        &measured,
        &["--quasi-static", "--column", "time_s=1", "--column", "output_counts=2"],
        ["column for the motor", "neither lost motion"],
    );
    let motor_only = ["--quasi-static", "--column", "time_s=1", "--column", "motor_counts=2"];
    refused(&measured, &motor_only, ["column for the output", "a motor alone shows no lost motion"]);
    let geared = with_torque(&Sweeps { loads: [0.0; 2], ..quick }, ",", |one| one.way);
    refused(&geared, &["--quasi-static"], ["not in one unit", "would have to be 3.0"]);
    refused(&geared, &["--quasi-static", "--gear-ratio", "-3"], ["not in one unit", "would have to be 3.0"]);
    let one_sweep: String = measured.lines().take(550).map(|line| format!("{line}\n")).collect();
    refused(&one_sweep, &MEASURED, ["no reversal", "sweep slowly"]);
    let three_sweeps: String = measured.lines().take(1790).map(|line| format!("{line}\n")).collect();
    refused(&three_sweeps, &MEASURED, ["too few passes: 1 backwards", "twice in each direction"]);
    refused(
        &measured,
        &with(&["--half", "0..48", "--half", "50..64"]),
        ["in the second half", "twice in each direction"],
    );
    let fast = Sweeps { sweep: 0.3, ..quick };
    let [first, second] = fast.halves();
    refused(
        &fast.as_measured(),
        &[&MEASURED[..], &["--half", &first, "--half", &second]].concat(),
        ["too fast", "sweep more slowly"],
    );
    let coarse = Sweeps { width: [1.0, 0.0], sweep: 1.0, rate: 60.0, loads: [0.0; 2], ..quick };
    refused(&coarse.as_measured(), &MEASURED, ["too fast", "from one sample to the next"]);
    let other_sign: String = Sweeps { loads: [0.0; 2], ..quick }
        .record()
        .iter()
        .map(|one| format!("{} {} {}\n", one.time, one.output, one.motor - one.output))
        .collect();
    refused(&other_sign, &MEASURED, ["ahead of the motor in both directions", "counts the other way"]);
    let against = with_torque(&quick, ",", |one| -3.0 * one.load + 0.5 * one.way);
    refused(&against, &GEARED, ["ahead of the motor while the torque drives it", "counts the other way"]);
    let mut falling: Vec<&str> = measured.lines().collect();
    falling.swap(300, 310);
    refused(&falling.join("\n"), &halves, ["time falls in line 302", "in the order"]);
    let mut spoiled: Vec<&str> = measured.lines().collect();
    spoiled[200] = "2.0 none 2000";
    let spoiled = spoiled.join("\n");
    refused(&spoiled, &halves, ["line 201 has no finite number", "number with a decimal point"]);
    let wrapped: String = Sweeps { loads: [0.0; 2], ..quick }
        .record()
        .iter()
        .map(|one| format!("{} {} {}\n", one.time, one.output.rem_euclid(700.0), one.output - one.motor))
        .collect();
    refused(&wrapped, &MEASURED, ["the output jumps by", "--output-units-per-turn"]);
    let still: String = quick.record().iter().map(|one| format!("{} 5 {}\n", one.time, 5.0 - one.motor)).collect();
    refused(&still, &MEASURED, ["the output does not move", "both encoders"]);
    // Errors of the options.
    refused(&measured, &with(&["--gear-ratio", "6"]), ["--gear-ratio has no effect", "leave the option out"]);
    refused(&measured, &with(&["--half", "0..48"]), ["--half is given 1 times", "twice"]);
    refused(&measured, &with(&["--half", "0..48", "--half", "40..90"]), ["halves overlap", "one direction at a time"]);
    refused(&measured, &with(&["--half", "48..0"]), ["--half", "less than the second"]);
    refused(&measured, &with(&["--joint", "q1"]), ["--joint", "cannot be used with"]);
    refused(&measured, &with(&["--motor-bits", "14"]), ["--motor-bits", "cannot be used with"]);
    refused(&measured, &["--gear-ratio", "6"], ["--quasi-static", "required"]);
    refused(&measured, &MEASURED[1..], ["only --quasi-static reads a column", "add --quasi-static"]);
    refused(&measured, &with(&["--topic", "/x"]), ["not an MCAP log", "leave --topic out"]);
}

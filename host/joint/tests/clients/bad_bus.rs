//! CAN bus under equal identifiers, noise, bus-off and floods: the twin reports each cause, nothing hangs, and the drive
//! goes to its safe state.

use crate::bad_clients::{VOLTAGE, count};
use crate::command::{joint, until};
use crate::line::Line;
use crate::twin::Twin;

/// Query of the position of moteus 1 with an answer, as a number with 4 bytes.
const MOTEUS_POSITION: &str = "can send 8001 1D01 BF\n";
/// Velocity mode of moteus 1 at 0.2 turns/s; its default watchdog is 0.1 s.
const MOTEUS_TURN: &str = "can send 8001 01000A0E200000C07FCDCC4C3E BF\n";

#[test]
fn equal_identifiers_collide_and_are_named() {
    let ids = ["--same-id", "--id", "1=q1", "--id", "1=d2"];
    let twin = Twin::start("moteus", &ids);
    let mut line = Line::terminal(twin.port());
    // Both drives answer with the identifier 100 at the same time. At rest their positions are alike, and so are their
    // frames, which do not collide then.
    // Sixteen attempts make both error passive; then one frame after the other arrives. A status may come amid them.
    until("sixteen collisions destroyed their frames", || {
        line.say(MOTEUS_TURN);
        line.say(MOTEUS_POSITION);
        line.read();
        twin.bus()["destroyed"].as_u64() >= Some(16)
    });
    let report = twin.bus();
    assert_eq!(report["collisions"][0]["id"], "100", "{report}");
    assert_eq!(report["collisions"][0]["nodes"].to_string(), r#"["1 = q1","1 = d2"]"#);
    line.hears("rcv 100 ");
    let summary = twin.end();
    assert!(summary.contains("1 = q1 and 1 = d2 sent the identifier 100 at the same time"), "{summary}");
}

#[test]
fn equal_identifiers_are_refused_without_the_option() {
    let ended = joint(&["twin", "--id", "1=q1", "--id", "1=d2"]);
    ended.refused(&["the identifier 1 is taken", "--same-id"]);
}

#[test]
fn drive_without_a_bus_times_out() {
    let twin = Twin::start("moteus", &[]);
    let mut line = Line::terminal(twin.port());
    until("the drive turns", || {
        line.say(MOTEUS_TURN);
        twin.status()["state"] == "Enabled"
    });
    twin.order(r#"{"can_errors": 1}"#);
    // The client goes on, but no frame arrives: the watchdog damps the motion.
    until("the watchdog expires", || {
        line.say(MOTEUS_TURN);
        twin.status()["state"] == "TimedOut"
    });
    until("the client is off the bus", || twin.bus()["off"][0]["node"] == "the client");
    twin.order(r#"{"end_faults": true}"#);
    line.forget();
    until("the drive answers", || {
        line.say(MOTEUS_POSITION);
        line.read();
        line.has(b"rcv 100 ")
    });
    let summary = twin.end();
    assert!(summary.contains("warning:  bus-off: the client, "), "{summary}");
}

/// CiA 402 reports the return from bus-off as 8140h. The others leave it to their watchdogs.
#[test]
fn cia402_reports_bus_off() {
    let twin = Twin::start("cia402", &[]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    // The drive has booted once it answers a guarding request as pre-operational, with either toggle.
    until("the drive has booted", || {
        line.say("r7011\r");
        line.read();
        ["t70117F", "t7011FF"].iter().any(|answer| line.has(answer.as_bytes()))
    });
    twin.order(r#"{"joint": 1, "bus_off": true}"#);
    line.hears("t0818408111");
    line.hears("t0818000000");
    assert_eq!(twin.status()["can_state"], "error_active");
    let summary = twin.end();
    assert!(summary.contains("warning:  bus-off: 1 = q1, 1 x"), "{summary}");
}

#[test]
fn noise_costs_time_and_no_frame() {
    const FRAMES: usize = 2000;
    let twin = Twin::start("odrive", &["--bitrate", "1000000"]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    twin.order(r#"{"can_errors": 0.05}"#);
    for _ in 0..FRAMES / 50 {
        line.say(&VOLTAGE.0.repeat(50));
    }
    until("all are answered", || {
        line.read();
        answers(&line) == FRAMES
    });
    let report = twin.bus();
    assert!(report["destroyed"].as_u64() > Some(FRAMES as u64 / 20) && report["lost"] == 0, "{report}");
    twin.end();
}

/// Frames of the highest priority fill the bus of 1 Mbit/s: the drive's own frames wait, and come afterwards.
#[test]
fn flood_takes_the_bus() {
    const FRAMES: usize = 10_000;
    let twin = Twin::start("odrive", &["--bitrate", "1000000"]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    line.say(VOLTAGE.0);
    line.hears(VOLTAGE.1);
    let flood = "t00080000000000000000\r".repeat(100);
    for _ in 0..FRAMES / 100 {
        line.say(&flood);
    }
    line.say(VOLTAGE.0);
    line.forget();
    line.hears(VOLTAGE.1);
    let report = twin.bus();
    // 10,000 frames of 131 bits, and the drive's cyclic messages, of which its queue holds 32.
    assert!(report["frames"].as_u64() > Some(FRAMES as u64), "{report}");
    assert!(report["load"].as_f64() > Some(0.5), "{report}");
    let summary = twin.end();
    assert!(summary.contains("% busy"), "{summary}");
}

/// A frame of 8 bytes takes 1 ms at 125 kbit/s, which is longer than the step.
#[test]
fn lockstep_waits_for_the_bus() {
    let twin = Twin::start("odrive", &["--lockstep", "0.1", "--bitrate", "125000"]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    for _ in 0..20 {
        line.forget();
        line.say(VOLTAGE.0);
        line.hears(VOLTAGE.1);
    }
    let time = twin.order("{}")["time_s"].as_f64().expect("a time");
    assert!((0.02..0.2).contains(&time), "{time}");
    twin.end();
}

#[test]
fn serial_bus_refuses_faults_of_can() {
    let twin = Twin::start("feetech", &[]);
    for key in ["can_errors", "bus_off"] {
        let answer = twin.order(&format!("{{\"{key}\": {}}}", if key == "bus_off" { "true" } else { "1" }));
        assert!(answer["error"].as_str().is_some_and(|error| error.contains(key)), "{answer}");
    }
    twin.end();
    joint(&["twin", "--drive", "feetech", "--bitrate", "1000000"]).refused(&["--bitrate", "serial bus"]);
}

/// Requests in bursts that the line holds: each is answered once. `TWIN_FRAMES` is their number.
#[test]
fn frames_arrive_without_a_loss() {
    const BURST: usize = 100;
    let frames = std::env::var("TWIN_FRAMES").map_or(50_000, |count| count.parse().expect("a number of frames"));
    let twin = Twin::endless("odrive", &[]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    let burst = VOLTAGE.0.repeat(BURST);
    for index in 0..frames / BURST {
        line.say(&burst);
        until("the burst is answered", || {
            line.read();
            answers(&line) >= BURST
        });
        assert_eq!(answers(&line), BURST, "burst {index}");
        line.heard.clear();
    }
    let report = twin.bus();
    let summary = twin.end();
    println!("{frames} requests, {} frames on the bus\n{summary}", report["frames"]);
    assert!(!summary.contains("not read in time") && !summary.contains("malformed"), "{summary}");
    assert!(count(&summary, " from clients") >= frames as u64, "{summary}");
}

/// Number of answers that arrived since the last [`Line::forget`].
fn answers(line: &Line) -> usize {
    line.heard.windows(VOLTAGE.1.len()).filter(|part| *part == VOLTAGE.1.as_bytes()).count()
}

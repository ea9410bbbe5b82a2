//! Unmodified Python clients of finished drives command `joint twin`, and bad clients do not disturb it.
//!
//! Each script beside this file connects, enables, moves by 0.1 turns, reads both encoders, lets the watchdog expire,
//! causes faults, clears them and disables. Its packages are pinned in the `.txt` file of its name.

mod bad_bus;
mod bad_clients;
#[path = "../command/mod.rs"]
mod command;
mod environment;
mod five_minutes;
mod image;
mod line;
mod lost_motion;
mod round_trips;
#[path = "../scripts/mod.rs"]
mod scripts;
mod twin;

use environment::Environment;
use report::workspace::workspace;
use twin::Twin;

/// Runs a check in real time, and once more if it failed: a busy machine can stall twin or client for longer than a
/// watchdog permits; a fault of either fails again.
fn once_more_if_failed(check: impl Fn() + std::panic::RefUnwindSafe) {
    if std::panic::catch_unwind(&check).is_err() {
        check();
    }
}

/// Runs the script of a client against a drive, then ends the twin by Ctrl-C.
fn passes(client: &str, drive: &str, twin_arguments: &[&str], words: &[&str]) {
    let environment = Environment::new(client);
    once_more_if_failed(|| {
        let twin = Twin::start(drive, twin_arguments);
        environment.run(&format!("{client}_client.py"), &[&[twin.port(), twin.control()], words].concat());
        let summary = twin.end();
        assert!(!summary.contains("malformed"), "{summary}");
    });
}

#[test]
fn moteus_client_on_fdcanusb_passes() {
    passes("moteus", "moteus", &["--wire", "fdcanusb"], &["fdcanusb"]);
}

#[test]
fn moteus_client_on_slcan_passes() {
    passes("moteus", "moteus", &["--wire", "slcan"], &["slcan"]);
}

#[test]
fn odrive_client_of_firmware_0_6_passes() {
    passes("odrive", "odrive", &[], &["0.6"]);
}

#[test]
fn odrive_client_of_firmware_0_5_passes() {
    passes("odrive", "odrive3", &[], &["0.5"]);
}

#[test]
fn damiao_client_passes() {
    passes("damiao", "damiao", &[], &["6006"]);
}

#[test]
fn cybergear_client_passes() {
    passes("cybergear", "cybergear", &[], &["cybergear"]);
}

#[test]
fn cybergear_client_on_a_robstride_passes() {
    passes("cybergear", "robstride", &[], &["rs-02"]);
}

#[test]
fn feetech_client_passes() {
    passes("feetech", "feetech", &[], &[]);
}

#[test]
#[ignore = "installs 110 MB: cargo test -p joint --test clients lerobot -- --ignored"]
fn lerobot_bus_on_a_damiao_passes() {
    passes("lerobot", "damiao", &[], &["damiao", "dm6006"]);
}

#[test]
#[ignore = "installs 110 MB: cargo test -p joint --test clients lerobot -- --ignored"]
fn lerobot_bus_on_a_feetech_passes() {
    passes("lerobot", "feetech", &[], &["feetech"]);
}

#[test]
fn cia402_client_passes() {
    let eds = workspace().join("drives/src/cia402/joint-drive.eds");
    passes("cia402", "cia402", &[], &[command::text(&eds)]);
}

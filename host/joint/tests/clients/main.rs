//! Unmodified Python clients of finished drives command `joint twin`, and bad clients do not disturb it.
//!
//! Each script beside this file connects, enables, moves by 0.1 turns, reads both encoders, lets the watchdog expire,
//! causes faults, clears them and disables. Its packages are pinned in the `.txt` file of its name.

mod bad_clients;
#[path = "../command/mod.rs"]
mod command;
mod environment;
mod image;
mod line;
mod lost_motion;
mod twin;

use environment::Environment;
use report::workspace::workspace;
use twin::Twin;

/// Runs the script of a client against a drive, then ends the twin by Ctrl-C.
fn passes(client: &str, drive: &str, twin_arguments: &[&str], words: &[&str]) {
    let environment = Environment::new(client);
    let twin = Twin::start(drive, twin_arguments);
    environment.run(&format!("{client}_client.py"), &[&[twin.port(), twin.control()], words].concat());
    let summary = twin.end();
    assert!(!summary.contains("malformed"), "{summary}");
}

/// Joint Q1 with a link of 0.5 N m.
fn light_joint(place: &tempfile::TempDir) -> std::path::PathBuf {
    let file = place.path().join("light.toml");
    let q1 = joint_file::preset("q1").expect("a preset");
    let light = joint_file::change(q1, "drive_train.gravity_torque_N_m", "0.5").expect("a key");
    std::fs::write(&file, light).expect("written");
    file
}

/// As [`passes`] with a link of 0.5 N m: at the supply of a small drive its current limit does not hold the weight of
/// Q1's link.
fn passes_with_a_light_link(client: &str, drive: &str, words: &[&str]) {
    let place = command::folder();
    let file = light_joint(&place);
    passes(client, drive, &[command::text(&file)], words);
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
    passes_with_a_light_link("cybergear", "cybergear", &["cybergear"]);
}

#[test]
fn cybergear_client_on_a_robstride_passes() {
    passes("cybergear", "robstride", &[], &["rs-02"]);
}

#[test]
fn feetech_client_passes() {
    passes_with_a_light_link("feetech", "feetech", &[]);
}

#[test]
fn cia402_client_passes() {
    let eds = workspace().join("drives/src/cia402/joint-drive.eds");
    passes("cia402", "cia402", &[], &[command::text(&eds)]);
}

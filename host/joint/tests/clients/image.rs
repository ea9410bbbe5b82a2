//! Unmodified clients drive the firmware image itself, on the model of the boards' registers: the model ends when the
//! client has left, and compares every frame of the image with the twin's.

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};

use report::workspace::workspace;

use crate::command::{folder, text};
use crate::environment::Environment;

/// Runs the script of a client against the image of a drive on a board.
fn image_passes(client: &str, maker: &str, board: &str, joint: &str, words: &[&str]) {
    let environment = Environment::new(client);
    let image = Command::new(env!("CARGO_BIN_EXE_joint"))
        .args(["image", joint, "--role", "drive", "--drive", maker, "--board", board])
        .output()
        .expect("the command can be started");
    assert!(image.status.success(), "{}", String::from_utf8_lossy(&image.stderr));
    let image = String::from_utf8(image.stdout).expect("text");
    let image = image.lines().next().expect("the path of the image");
    let mut model = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["run", "--release", "--quiet", "--manifest-path", "board-model/Cargo.toml", "--", "run", image])
        .args(["--board", board, "--twin", maker, "--joint", joint])
        .current_dir(workspace())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .expect("cargo can be started");
    let mut out = BufReader::new(model.stdout.take().expect("a pipe"));
    let port = loop {
        let mut line = String::new();
        out.read_line(&mut line).expect("text");
        assert!(!line.is_empty(), "the model ended at its start");
        if let Some(port) = line.trim_end().strip_prefix("CAN bus at ").and_then(|rest| rest.strip_suffix(": slcan")) {
            break port.to_owned();
        }
    };
    environment.run(&format!("{client}_client.py"), &[&[port.as_str(), "-"], words].concat());
    let mut rest = String::new();
    out.read_to_string(&mut rest).expect("text");
    assert!(model.wait().expect("it ends").success() && rest.contains("frames are the twin's"), "{rest}");
}

#[test]
#[ignore = "builds an image and the model of the boards' registers: minutes"]
fn odrive_client_drives_the_image() {
    image_passes("odrive", "odrive3", "odrive-3.6", "q1", &["0.5"]);
}

#[test]
#[ignore = "builds an image and the model of the boards' registers: minutes"]
fn moteus_client_drives_the_image() {
    // At 5 kHz the drive is too soft for the weight of Q1's link.
    let place = folder();
    let light = place.path().join("light.toml");
    let q1 = joint_file::preset("q1").expect("a preset");
    let text_of_light = joint_file::change(q1, "drive_train.gravity_torque_N_m", "0.5").expect("a key");
    std::fs::write(&light, text_of_light).expect("written");
    image_passes("moteus", "moteus", "moteus-r4", text(&light), &["slcan"]);
}

/// The other kind of FDCAN, whose message RAM the firmware lays out.
#[test]
#[ignore = "builds an image and the model of the boards' registers: minutes"]
fn moteus_client_drives_the_h743_image() {
    image_passes("moteus", "moteus", "nucleo-h743zi", "q1", &["slcan"]);
}

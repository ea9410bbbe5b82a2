//! Bad input to every command: unreadable files, impossible numbers, output paths that would overwrite an input. Errors
//! within a readable file are tested beside the reader of its format.

mod command;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use command::{folder, joint, text};

/// A test file that runs in a fraction of a second.
const SHORT: &str = "duration_s = 0.2\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nrivals = []\n";

/// Paths that no command can read: missing, folder, pipe, endless, empty, binary, not UTF-8.
fn unreadable_files(folder: &Path) -> Vec<PathBuf> {
    let write = |name: &str, content: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, content).expect("a file");
        path
    };
    // The pipe has no writer: a command that opened it would wait for ever.
    let pipe = folder.join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("`mkfifo` is there").success());
    let all_bytes: Vec<u8> = (0..=255).cycle().take(2048).collect();
    vec![
        folder.join("missing"),
        folder.to_owned(),
        pipe,
        "/dev/zero".into(),
        write("empty", b""),
        write("garbage", &all_bytes),
        write("no-utf8", b"name = \"\xff\"\n"),
        write("utf16", b"\xff\xfen\0a\0m\0e\0"),
    ]
}

/// The message names the file, and no output folder is created.
#[test]
fn unreadable_file_is_named_by_every_command() {
    let place = folder();
    let inputs = folder();
    let out = place.path().join("out");
    let out = text(&out);
    let commands: [&[&str]; 18] = [
        &["check", "@"],
        &["board", "check", "@"],
        &["board", "check", "olimex-h405", "--joint", "@"],
        &["replay", "@", "--out", out],
        &["budget", "@"],
        &["image", "@"],
        &["flash", "@", "--board", "nucleo-g474re"],
        &["sim", "@", "--out", out],
        &["sim", "q1", "--profile", "@", "--out", out],
        &["sweep", "@", "--vary", "half_backlash_um=10,20", "--out", out],
        &["hil", "@", "--no-reference", "--picture", "x.svg", "--out", out],
        &["hil", "@", "--host", "--out", out],
        &["hil", "q1", "--profile", "@", "--out", out],
        &["identify", "@", "--out", out],
        &["identify", "log.csv", "--joint", "@", "--out", out],
        &["memory", "show", "@"],
        &["memory", "write", "@"],
        &["task", "@", "--number", "0"],
    ];
    for input in unreadable_files(inputs.path()) {
        for command in commands {
            let named: Vec<&str> = command.iter().map(|word| if *word == "@" { text(&input) } else { word }).collect();
            joint(&named).refused(&[text(&input), "help:"]);
        }
    }
    assert!(!place.path().join("out").exists(), "nothing is begun before its input has been read");
}

#[test]
fn crlf_and_byte_order_mark_accepted() {
    let place = folder();
    let q1 = joint_file::preset("q1").expect("a preset");
    let rows = "time_s,motor_torque_Nm,load_torque_Nm\n0,1,6\n0.1,-1,-6\n";
    for (name, content) in [("joint.toml", q1), ("test.toml", SHORT), ("torques.csv", rows)] {
        for other in [content.replace('\n', "\r\n"), format!("\u{feff}{content}")] {
            fs::write(place.path().join(name), other).expect("a file");
            let (file, out) = (place.path().join(name), place.path().join("out"));
            let (file, out) = (text(&file), text(&out));
            match name {
                "joint.toml" => joint(&["check", file]).succeeded(),
                "test.toml" => joint(&["hil", file, "--host", "--out", out]).succeeded(),
                _ => joint(&["sim", "q1", "--profile", file, "--out", out]).succeeded(),
            };
        }
    }
}

#[test]
fn output_over_input_rejected() {
    let place = folder();
    let [file, test, torques, out] =
        ["joint.toml", "test.toml", "torques.csv", "out"].map(|name| place.path().join(name));
    fs::write(&file, joint_file::preset("q1").expect("a preset")).expect("a file");
    fs::write(&test, SHORT).expect("a file");
    fs::write(&torques, "time_s,motor_torque_Nm,load_torque_Nm\n0,1,6\n0.1,-1,-6\n").expect("a file");
    let [file, test, torques, out] = [&file, &test, &torques, &out].map(text);
    let before = command::contents(place.path());
    let commands: [&[&str]; 8] = [
        &["check", file, "--json", file],
        &["budget", file, "--json", file],
        &["sim", file, "--json", file, "--out", out],
        &["sim", "q1", "--profile", torques, "--json", torques, "--out", out],
        &["hil", file, "--picture", file, "--out", out],
        &["hil", test, "--host", "--json", test, "--out", out],
        &["hil", test, "--host", "--junit", test, "--out", out],
        &["identify", file, "--simulate", "--joint", file],
    ];
    for command in commands {
        joint(command).refused(&["would write over", "name another file"]);
    }
    let both = place.path().join("both");
    let both = text(&both);
    joint(&["hil", test, "--host", "--json", both, "--junit", both]).refused(&["--json and --junit both name"]);
    assert_eq!(command::contents(place.path()), before);
}

#[test]
fn unwritable_output_rejected_before_run() {
    let place = folder();
    let nowhere = place.path().join("none/x");
    for option in ["--json", "--picture"] {
        joint(&["hil", "q1", option, text(&nowhere)]).refused(&["none", option]);
    }
}

/// The message lists the boards with the role.
#[test]
fn missing_role_names_boards_that_have_it() {
    joint(&["image", "q1", "--drive", "odrive"]).refused(&["--drive is for the role drive, not plant", "--role drive"]);
    joint(&["image", "q1", "--role", "loop", "--id", "3"]).refused(&["--id is for the role drive, not loop"]);
    joint(&["image", "q1", "--role", "drive", "--drive", "acme"]).refused(&["acme", "odrive3", "cia402"]);
    let drive = ["image", "q1", "--role", "drive", "--board", "feather-f405"];
    joint(&drive).refused(&["no [can]", "nucleo-g474re, nucleo-h743zi, odrive-3.6"]);
    let spi = ["image", "q1", "--role", "spi-observer", "--board", "nucleo-h743zi"];
    joint(&spi).refused(&["nucleo-h743zi is no slave on SPI", "olimex-h405, nucleo-g474re", "--role observer"]);
}

#[test]
fn controller_options_need_a_controller() {
    let plant = ["export", "q1", "--fmu", "2", "--out", "q1.fmu"];
    let with = |options: &[&'static str]| [plant.as_slice(), options].concat();
    joint(&with(&["--motor-only"])).refused(&["--motor-only: the FMU of a plant", "--model controller"]);
    joint(&with(&["--bandwidth", "40"])).refused(&["--bandwidth: the FMU of a plant", "--model controller"]);
    joint(&with(&["--model", "controller", "--told", "s1"])).refused(&["--told"]);
}

#[test]
fn chip_name_is_not_a_board() {
    joint(&["flash", "q1"]).refused(&["no board is named", "--board", "odrive-3.6"]);
    let chip = ["is a chip, not a board", "olimex-h405, odrive-3.6, feather-f405"];
    joint(&["image", "q1", "--board", "stm32f405"]).refused(&chip);
    joint(&["board", "check", "stm32f405"]).refused(&chip);
    joint(&["image", "q1", "--board", "no_such"]).refused(&["no_such", "nucleo-g474re"]);
    let place = folder();
    let file = place.path().join("mine.toml");
    let text = fs::read_to_string(report::workspace::workspace().join("boards/odrive-3.6.toml")).expect("a preset");
    fs::write(&file, text + "[light]\npin = \"PB10\"\non = \"high\"\n").expect("written");
    let mine = file.to_str().expect("a path");
    joint(&["board", "check", mine]).refused(&["PB10", "brake"]);
    joint(&["image", "q1", "--board", mine]).refused(&["PB10", "brake"]);
}

#[test]
fn board_check_shows_pins() {
    let shown = joint(&["board", "check", "nucleo-g474re"]).succeeded().out;
    for words in [
        "loop  ",
        "fits: 42 % of flash",
        "predicted from",
        "STM32G474RE",
        "crystal of 24 MHz",
        "USART2: PA2 out, PA3 in, 460800 baud",
        "PA13",
    ] {
        assert!(shown.contains(words), "{shown}");
    }
    assert!(joint(&["board", "list"]).succeeded().out.contains("moteus-r4"));
}

#[test]
fn impossible_numbers_rejected() {
    let place = folder();
    let out = text(place.path());
    let lines: [(&[&str], &str); 9] = [
        (&["check", "--rate", "-5"], "-5"),
        (&["image", "--rate", "-1"], "-1"),
        (&["identify", "log.csv", "--torque-error", "-1"], "0 to 50 percent"),
        (&["identify", "log.csv", "--simulate", "--seed", "-1"], "-1"),
        (&["hil", "q1", "--rate", "1", "--out", out], "below 2473 Hz no step is stable"),
        (&["sim", "--drive", "1e308", "--out", out], "check the unit"),
        (&["sim", "--load", "-1e7", "--out", out], "check the unit"),
        (&["sim", "--speed", "1e6", "--out", out], "check the unit"),
        (&["sim", "--duration", "1e308", "--out", out], "a run of 1e308 s"),
    ];
    for (line, words) in lines {
        let ended = joint(line);
        ended.refused(&[words]);
        assert!(!ended.err.contains("unexpected argument"), "{line:?}: {ended:?}");
    }
    joint(&["sim", "--drive", "-1", "--duration", "0.01", "--out", out]).succeeded();
}

/// Every command must print the warnings and errors of a joint file.
#[test]
fn odd_joint_warned_impossible_joint_rejected() {
    let place = folder();
    let q1 = joint_file::preset("q1").expect("a preset");
    let [odd, none, out, log] = ["odd.toml", "none.toml", "out", "log.csv"].map(|name| place.path().join(name));
    fs::write(&odd, q1.replace("gravity_torque_N_m = 6.0", "gravity_torque_N_m = 13.0")).expect("a file");
    fs::write(&none, q1.replace("planet_mass_kg = 0.05", "planet_mass_kg = 50")).expect("a file");
    let test = place.path().join("test.toml");
    let commands = |joint: &Path| -> Vec<Vec<String>> {
        fs::write(&test, format!("joint = \"{}\"\n{SHORT}", text(joint))).expect("a file");
        let lines: [&[&str]; 6] = [
            &["check", text(joint)],
            &["budget", text(joint)],
            &["sim", text(joint), "--duration", "0.01", "--no-energy", "--out", text(&out)],
            &["sweep", text(joint), "--vary", "half_backlash_um=30,40", "--duration", "0.01", "--out", text(&out)],
            &["hil", text(&test), "--host", "--out", text(&out)],
            &["identify", text(&log), "--simulate", "--joint", text(joint)],
        ];
        lines.iter().map(|line| line.iter().map(ToString::to_string).collect()).collect()
    };
    for line in commands(&odd) {
        let words: Vec<&str> = line.iter().map(String::as_str).collect();
        let ended = joint(&words).succeeded();
        let said = if line[0] == "check" { &ended.out } else { &ended.err };
        assert!(said.contains("warning") && said.contains("gravity_torque_N_m"), "{line:?}: {ended:?}");
        let _ = fs::remove_dir_all(&out);
    }
    for line in commands(&none) {
        let words: Vec<&str> = line.iter().map(String::as_str).collect();
        joint(&words).refused(&["planet_mass_kg", "likely typed in g"]);
    }
}

//! Behaviour at the prompt: choice between a preset and a file of its name, contents of standard output, folders of
//! results, installation of packages.

mod command;
mod pseudo_terminal;

use std::fs;

use command::{QUICK_ROWS, folder, joint, joint_in, joint_with, send, start, text, until, wait, write_short_log};

/// A bare name means the preset, unless a file has exactly the name; the note states the choice.
#[test]
fn preset_and_file_of_one_name_are_noted() {
    let place = folder();
    let mine = fs::read_to_string(report::workspace::workspace().join("joints/s1.toml")).expect("a preset");
    fs::write(place.path().join("q1.toml"), &mine).expect("room");
    let beside = joint_in(place.path(), &["check", "q1"]).succeeded();
    assert!(beside.out.starts_with("Q1"), "{beside:?}");
    assert_eq!(
        beside.err,
        "note: `q1` is the preset of that name, not the file q1.toml in this folder: name that ./q1.toml\n"
    );
    fs::write(place.path().join("q1"), &mine).expect("room");
    let same = joint_in(place.path(), &["check", "q1"]).succeeded();
    assert!(same.out.starts_with("S1"), "{same:?}");
    assert_eq!(same.err, "note: `q1` is the file of that name in this folder, not the preset q1\n");
    for plain in ["./q1", "q1.toml", "s1"] {
        assert_eq!(
            joint_in(place.path(), &["check", plain]).succeeded().err,
            "",
            "{plain}: there is no other of that name"
        );
    }
}

/// `hil` with a joint on a board has its own test of `--json -` in `command_failure_modes`.
#[test]
fn json_dash_prints_json_alone() {
    let place = folder();
    fs::write(
        place.path().join("test.toml"),
        "duration_s = 0.2\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nrivals = []\n",
    )
    .expect("room");
    write_short_log(&place.path().join("log.csv"), QUICK_ROWS);
    let commands: [&[&str]; 5] = [
        &["check"],
        &["budget"],
        &["sim", "l1", "--duration", "0.02", "--out", "sim"],
        &["hil", "test.toml", "--host", "--out", "tests"],
        &["identify", "log.csv", "--out", "identified"],
    ];
    for command in commands {
        let ended = joint_in(place.path(), &[command, &["--json", "-"]].concat()).succeeded();
        let found: Result<serde_json::Value, _> = serde_json::from_str(&ended.out);
        assert!(found.is_ok_and(|found| found["schema"].is_string()), "{command:?}: {}", ended.out);
    }
    assert!(!place.path().join("-").exists());
}

/// The reference always runs in f64, so these options would be ignored silently.
#[test]
fn options_without_effect_on_reference_rejected() {
    for option in ["--f64", "--accurate"] {
        let words = [option, "has no effect on --scheme reference", "leave it out"];
        joint_in(folder().path(), &["sim", "--scheme", "reference", option]).refused(&words);
        let vary = ["sweep", "q1", "--vary", "half_backlash_um=10,20", "--scheme", "reference", option];
        joint_in(folder().path(), &vary).refused(&words);
    }
}

#[test]
fn completions_contain_commands_and_options() {
    let place = folder();
    for shell in ["bash", "zsh", "fish"] {
        let script = joint_in(place.path(), &["completions", shell]).succeeded().out;
        for word in ["hil", "completions", "no-reference", "lockstep"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    joint_in(place.path(), &["completions", "cmd"]).refused(&["cmd", "bash"]);
}

#[test]
fn version_names_commit() {
    let said = joint_in(folder().path(), &["--version"]).succeeded().out;
    let (version, commit) = said.trim_end().split_once(" (commit ").unwrap_or((said.trim_end(), ""));
    assert_eq!(version, format!("joint {}", env!("CARGO_PKG_VERSION")));
    let known = report::provenance::git_commit();
    assert_eq!(commit.is_empty(), known.is_none(), "{said}");
    let digits = commit.trim_end_matches(')').trim_end_matches(", changed");
    assert!(known.is_none_or(|known| known.starts_with(digits)), "{said}");
}

/// Two runs must not mix their files; a killed run must not block the folder.
#[test]
fn second_run_into_busy_folder_rejected() {
    let place = folder();
    let out = text(place.path());
    let first = start(&["sim", "l1", "--duration", "3600", "--every", "2000", "--no-energy", "--out", out]);
    until("the history grows", || place.path().join("history.partial.csv").exists());
    let short = ["sim", "l1", "--duration", "0.02", "--no-energy", "--out", out];
    joint(&short).refused(&["another run is writing to", out, "--out DIR"]);
    assert!(!place.path().join("history.csv").exists());
    send("-KILL", &first);
    wait(first);
    joint(&short).succeeded();
    assert_eq!(fs::read_to_string(place.path().join("history.csv")).expect("whole").lines().count(), 402);
}

#[test]
fn results_default_to_working_folder() {
    let place = folder();
    joint_in(place.path(), &["sim", "l1", "--duration", "0.02", "--no-energy"]).succeeded();
    assert!(place.path().join("joint-out/sim/l1/report.html").is_file());
    joint_in(place.path(), &["sweep", "l1", "--vary", "half_backlash_um=10,20", "--duration", "0.01"]).succeeded();
    assert_eq!(fs::read_dir(place.path().join("joint-out/sweep")).expect("a folder").count(), 1);
    let mine = place.path().join("joint-out/sim/l1/report.html");
    fs::write(&mine, "my notes").expect("room");
    joint_in(place.path(), &["sim", "l1", "--duration", "0.02"])
        .refused(&["report.html has been changed", "--out DIR"]);
    assert_eq!(fs::read_to_string(mine).expect("still there"), "my notes");
}

/// Seen to fail: title, file name and argument reached the terminal unescaped.
#[test]
fn control_characters_are_shown_escaped() {
    let place = folder();
    let q1 = joint_file::preset("q1").expect("a preset");
    let evil = "\u{1b}]0;x\u{7}\u{1b}[2J\u{202e}";
    let hidden = "\\u001b[31mQ1\\u009b2J\\u202e";
    let named = q1.replacen("name = \"Q1\"", &format!("name = \"{hidden}\""), 1);
    let described = q1.replacen("description = \"", &format!("description = \"{hidden}"), 1);
    assert!(named != q1 && described != q1);
    fs::write(place.path().join("named.toml"), &named).expect("room");
    fs::write(place.path().join("described.toml"), &described).expect("room");
    fs::write(place.path().join("broken.toml"), "# \u{202e}\nnonsense = \"\u{202e}\"\n").expect("room");
    fs::write(place.path().join(format!("{evil}.toml")), "nonsense = 1\n").expect("room");
    let title =
        "title = \"\\u001b[31mtitle\"\nduration_s = 0.2\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nrivals = []\n";
    fs::write(place.path().join("test.toml"), title).expect("room");
    let evil_file = format!("{evil}.toml");
    let no_such = format!("{evil}missing");
    let lines: [(&[&str], i32); 9] = [
        (&["check", "named.toml"], 2),
        (&["check", "described.toml"], 0),
        (&["check", "described.toml", "--json", "-"], 0),
        (&["check", "broken.toml"], 2),
        (&["check", &evil_file], 2),
        (&["check", &no_such], 2),
        (&["image", "--board", &no_such], 2),
        (&["check", &format!("--{no_such}")], 2),
        (&["hil", "test.toml", "--host", "--out", "tests"], 0),
    ];
    for (line, code) in lines {
        let ended = joint_in(place.path(), line);
        assert_eq!(ended.code, Some(code), "{line:?}: {ended:?}");
        for said in [&ended.out, &ended.err] {
            assert!(report::escape::is_plain(said), "{line:?}: {ended:?}");
        }
        if code == 2 {
            assert!(ended.err.contains("\\u{202e}"), "{line:?} does not show what is there: {ended:?}");
        }
    }
    for file in ["tests/report.html", "tests/results.json", "tests/junit.xml"] {
        let path = place.path().join(file);
        let text = fs::read_to_string(&path).unwrap_or_default();
        assert!(!text.contains('\u{1b}'), "{file}");
    }
}

/// Creates fake `dpkg-query` and `apt-get` in a folder: no package is installed, and the arguments of `apt-get` are
/// recorded.
fn debian(place: &std::path::Path) -> String {
    use std::os::unix::fs::PermissionsExt;
    let asked = place.join("asked");
    for (name, script) in
        [("dpkg-query", "exit 1".to_owned()), ("apt-get", format!("echo \"$@\" >> {}", asked.display()))]
    {
        let path = place.join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("room");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("ours");
    }
    text(place).to_owned()
}

/// Returns true if the test runs as root. Without root the command only names the missing packages.
fn is_root() -> bool {
    use std::os::unix::fs::MetadataExt;
    fs::metadata("/proc/self").is_ok_and(|data| data.uid() == 0)
}

#[test]
fn packages_not_installed_if_forbidden() {
    let place = folder();
    let path = debian(place.path());
    let words =
        ["not installed, but needed to run the emulated board: qemu-system-arm", "apt-get install qemu-system-arm"];
    let hil = |arguments: &[&str], variable: &str| {
        let variables = [("PATH", path.as_str()), ("JOINT_INSTALL", variable)];
        joint_with(&[&["hil", "q1"], arguments].concat(), &variables)
    };
    hil(&[], "no").refused(&words);
    hil(&["--install", "no"], "yes").refused(&words);
    hil(&[], "never").refused(&["JOINT_INSTALL=never", "yes, no or ask"]);
    assert!(!place.path().join("asked").exists());
    if !is_root() {
        return;
    }
    let without_terminal = hil(&[], "");
    assert!(without_terminal.err.contains("`--install no` or JOINT_INSTALL=no forbids that"), "{without_terminal:?}");
    let asked = fs::read_to_string(place.path().join("asked")).expect("`apt-get` was started");
    assert!(asked.contains("install --yes --no-install-recommends qemu-system-arm"), "{asked}");
}

#[test]
fn packages_installed_only_after_yes() {
    use std::io::{Read, Write};
    if !is_root() {
        return;
    }
    for (answer, installs) in [("n\n", false), ("y\n", true)] {
        let place = folder();
        let path = debian(place.path());
        let (mut master, slave, _) = pseudo_terminal::pair();
        let end = |file: &fs::File| std::process::Stdio::from(file.try_clone().expect("a terminal"));
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_joint"))
            .args(["hil", "q1"])
            .env("PATH", &path)
            .env_remove("JOINT_INSTALL")
            .stdin(end(&slave))
            .stdout(std::process::Stdio::null())
            .stderr(end(&slave))
            .spawn()
            .expect("the command can be started");
        let mut said = String::new();
        until("the question comes", || {
            let mut bytes = [0; 1024];
            if let Ok(read) = master.read(&mut bytes) {
                said += &String::from_utf8_lossy(&bytes[..read]);
            }
            said.contains("[y/N]")
        });
        assert!(said.contains("qemu-system-arm must be installed to run the emulated board"), "{said}");
        assert!(!place.path().join("asked").exists(), "nothing is installed before the answer");
        master.write_all(answer.as_bytes()).expect("a terminal");
        assert_eq!(child.wait().expect("it ends").code(), Some(2));
        assert_eq!(place.path().join("asked").exists(), installs, "{answer:?}");
    }
}

//! Every program runs, ends successfully and prints finite numbers.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Path of a program of this package: Cargo puts it beside the folder of its tests.
fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test has a path");
    let folder = test.ancestors().nth(2).expect("a test is in a folder of the target folder");
    folder.join("examples").join(name).with_extension(std::env::consts::EXE_EXTENSION)
}

fn run(name: &str, arguments: &[&str]) -> Output {
    let output = Command::new(program(name)).args(arguments).output();
    output.unwrap_or_else(|error| panic!("{name}: {error}; `cargo test -p examples` builds it"))
}

/// Output of a program, whose numbers are checked to be finite.
fn printed(name: &str, arguments: &[&str]) -> String {
    let output = run(name, arguments);
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    let words = || text.split(|letter: char| !(letter.is_alphanumeric() || "+-._".contains(letter)));
    let numbers = words().filter_map(|word| word.parse::<f64>().ok());
    assert!(numbers.clone().count() > 3, "{name} prints no numbers:\n{text}");
    assert!(numbers.clone().all(f64::is_finite), "{name} prints a number that is none:\n{text}");
    text
}

/// Numbers of a line.
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// The model crosses its gap from flank to flank.
#[test]
fn stepped_model_crosses_its_gap() {
    let text = printed("step_a_model", &[]);
    assert!(text.contains("DriveSide") && text.contains("BackSide") && text.contains("Separated"), "{text}");
}

/// The tables are printed as a Rust module.
#[test]
fn designed_tables_are_a_rust_module() {
    let text = printed("design_and_print_tables", &["s1", "10000"]);
    assert!(text.starts_with("// S1 at 10000 Hz") && text.contains("pub static TABLES"), "{text}");
}

/// A missing joint file ends the program with exit code 2.
#[test]
fn unreadable_joint_sets_exit_code() {
    let output = run("design_and_print_tables", &["no/such/joint.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no/such/joint.toml"));
}

/// The observer estimates a half-backlash worn from 40 to 55 um.
#[test]
fn log_reveals_worn_gap() {
    let text = printed("observe_a_log", &[]);
    let last = numbers(text.lines().last().unwrap_or_default());
    let [.., half_backlash_um, deviation_um] = last[..] else { panic!("{text}") };
    assert!((half_backlash_um - 55.0).abs() < 2.0 && deviation_um < 2.0, "{text}");
}

/// Bad logs are rejected with a reason and without a panic.
#[test]
fn invalid_log_is_rejected() {
    let file = std::env::temp_dir().join(format!("no-log-{}.csv", std::process::id()));
    let head = "time_s,motor_counts,output_counts,motor_torque_N_m\n";
    for (text, why) in [
        ("time,motor,output,torque\n0,0,0,0\n".to_owned(), "the columns of a log are"),
        (format!("{head}0,0,0,0\n0.0001,0,0\n"), "fields"),
        (format!("{head}0,0,0,zero\n"), "float"),
        (format!("{head}0,0,0,0\n"), "less than two rows"),
    ] {
        std::fs::write(&file, &text).expect("a folder for temporary files");
        let output = run("observe_a_log", &[file.to_str().expect("a plain name")]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{text}{said}");
        assert!(said.contains(why) && !said.contains("panicked"), "{text}{said}");
    }
    std::fs::remove_file(&file).expect("it was written");
}

/// The design states a half-gap of 60 um; the joint has 40 um.
#[test]
fn closed_loop_finds_and_crosses_the_gap() {
    let text = printed("close_a_loop", &[]);
    let rows: Vec<Vec<f64>> = text.lines().map(numbers).filter(|row| row.len() == 4).collect();
    let [first, .., last] = &rows[..] else { panic!("{text}") };
    assert!((last[1] - 40.0).abs() < 2.0 && last[2] < 2.0, "{text}");
    assert!(last[3] < first[3] / 5.0, "{text}");
}

/// Folder of the workspace.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("examples are in the workspace").to_owned()
}

/// The project of its own builds outside the workspace and estimates the lost motion.
#[test]
fn own_project_builds_and_finds_lost_motion() {
    let (workspace, folder) = (workspace(), tempfile::tempdir().expect("a folder"));
    let from = workspace.join("examples/own-project");
    fs::create_dir(folder.path().join("src")).expect("a folder");
    for name in ["build.rs", "my_joint.toml", "src/main.rs", "src/control.rs"] {
        fs::copy(from.join(name), folder.path().join(name)).expect("a file");
    }
    let manifest = fs::read_to_string(from.join("Cargo.toml")).expect("a manifest");
    let elsewhere = manifest.replace("path = \"../..", &format!("path = \"{}", workspace.display()));
    fs::write(folder.path().join("Cargo.toml"), elsewhere).expect("a manifest");
    // Lock file of the workspace, whose versions are all present.
    fs::copy(workspace.join("Cargo.lock"), folder.path().join("Cargo.lock")).expect("a lock file");
    let target = program("own-project").ancestors().nth(3).expect("a target folder").join("own-project");
    let output = Command::new(env!("CARGO"))
        .args(["run", "--offline"])
        .current_dir(folder.path())
        .env("CARGO_TARGET_DIR", target)
        .output()
        .expect("cargo");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("warning"), "{said}");
    let text = String::from_utf8(output.stdout).expect("text");
    let last = numbers(text.lines().last().unwrap_or_default());
    let [_, error_mrad, lost_motion_arcmin] = last[..] else { panic!("{text}") };
    assert!((lost_motion_arcmin - 3.0).abs() < 0.06 && error_mrad.abs() < 0.1, "{text}");
}

/// README shows code from the project's files.
#[test]
fn readme_shows_the_own_project() {
    let read = |name: &str| fs::read_to_string(workspace().join(name)).expect("a file");
    let readme = read("README.md");
    let files = ["build.rs", "src/control.rs"].map(|name| read(&format!("examples/own-project/{name}")));
    let blocks: Vec<&str> = readme.split("```rust\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(blocks.len(), 2, "the build script and the control");
    for block in blocks {
        assert!(files.iter().any(|file| file.contains(block.trim_end())), "README shows what no file has:\n{block}");
    }
}

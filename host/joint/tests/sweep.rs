//! `joint sweep` and `joint merge` at the command line: equal bytes for any threads, shards, kills and order; foreign
//! files stay untouched; every error has its cause and remedy.

mod command;

use std::fs;
use std::path::{Path, PathBuf};

use command::{Ended, contents, folder, interrupt, joint, joint_on_a_full_disk, start, text, until, wait};

/// Grid of 31 points of a few milliseconds each.
const GRID: [&str; 6] = ["sweep", "paper", "--vary", "half_backlash_um=0:150:5", "--duration", "0.01"];

fn sweep(more: &[&str], out: &Path) -> Ended {
    joint(&[&GRID[..], more, &["--out", text(out)]].concat())
}

fn result(folder: &Path) -> String {
    fs::read_to_string(folder.join("points.csv")).expect("the result")
}

/// Result of an uninterrupted sweep.
fn whole(folder: &Path) -> String {
    let path = folder.join("whole");
    sweep(&[], &path).succeeded();
    result(&path)
}

fn journal(folder: &Path) -> PathBuf {
    folder.join("journal-1-of-1.csv")
}

fn lines(path: &Path) -> usize {
    fs::read(path).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count())
}

#[test]
fn threads_and_shards_give_equal_bytes() {
    let folder = folder();
    let expected = whole(folder.path());
    assert_eq!(expected.lines().count(), 32);
    for threads in ["1", "2", "7"] {
        let path = folder.path().join(threads);
        sweep(&["--threads", threads], &path).succeeded();
        assert_eq!(result(&path), expected, "{threads} threads");
    }
    // Shards in one folder, the last one first; the shard that completes the grid writes the result.
    let together = folder.path().join("together");
    for shard in ["3/3", "1/3"] {
        let ended = sweep(&["--shard", shard], &together).succeeded();
        assert!(ended.out.contains("cargo joint merge"), "{ended:?}");
        assert!(!together.join("points.csv").exists());
    }
    sweep(&["--shard", "2/3"], &together).succeeded();
    assert_eq!(result(&together), expected);
}

#[test]
fn merge_needs_all_shards() {
    let folder = folder();
    let expected = whole(folder.path());
    let paths = ["1/3", "2/3", "3/3"].map(|shard| {
        let path = folder.path().join(shard.replace('/', "-of-"));
        sweep(&["--shard", shard], &path).succeeded();
        path
    });
    let [one, two, three] = paths.each_ref().map(text);
    let out = folder.path().join("merged");
    joint(&["merge", one, three, "--out", text(&out)])
        .refused(&["10 of 31 points are missing: 1, 4, 7", "--shard 2/3"]);
    assert!(!out.exists());
    joint(&["merge", three, one, two, "--out", text(&out)]).succeeded();
    assert_eq!(result(&out), expected);
    // Merging again does no harm.
    joint(&["merge", one, two, three, "--out", text(&out)]).succeeded();
    assert_eq!(result(&out), expected);
}

#[test]
fn paper_period_classes_found() {
    let folder = folder();
    let path = folder.path().join("classes");
    let grid = ["sweep", "paper", "--vary", "half_backlash_um=0,10,19,25,34,38,50,60,69,70,80,120"];
    joint(&[&grid[..], &["--metric", "period", "--out", text(&path)]].concat()).succeeded();
    let periods: Vec<String> =
        result(&path).lines().skip(1).map(|line| line.rsplit(',').next().unwrap_or_default().to_owned()).collect();
    assert_eq!(periods, ["1", "1", "1", "2", "2", "0", "3", "3", "3", "6", "0", "0"]);
}

#[test]
fn killed_sweep_resumes_to_equal_bytes() {
    let folder = folder();
    let grid = ["sweep", "paper", "--vary", "half_backlash_um=0:150:0.5", "--duration", "0.01", "--threads", "1"];
    let run = |path: &Path| [&grid[..], &["--out", text(path)]].concat().iter().map(ToString::to_string).collect();
    let expected = {
        let path = folder.path().join("whole");
        let arguments: Vec<String> = run(&path);
        joint(&arguments.iter().map(String::as_str).collect::<Vec<_>>()).succeeded();
        result(&path)
    };
    let path = folder.path().join("killed");
    let arguments: Vec<String> = run(&path);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    for wanted in [5, 60] {
        let mut child = start(&arguments);
        until("some points are kept", || lines(&journal(&path)) > wanted);
        child.kill().expect("it runs");
        wait(child);
    }
    let kept = lines(&journal(&path)) - 1;
    assert!((60..301).contains(&kept), "{kept}");
    assert!(!path.join("points.csv").exists());
    let ended = joint(&arguments).succeeded();
    assert!(ended.err.contains("continuing:"), "{ended:?}");
    assert_eq!(result(&path), expected);
}

#[test]
fn truncated_journal_line_recomputed() {
    let folder = folder();
    let expected = whole(folder.path());
    let path = folder.path().join("whole");
    let bytes = fs::read(journal(&path)).expect("a journal");
    for cut in [bytes.len() - 1, bytes.len() - 30, bytes.len() / 2, 40, 0] {
        fs::write(journal(&path), &bytes[..cut]).expect("room");
        fs::remove_file(path.join("points.csv")).expect("it was there");
        sweep(&[], &path).succeeded();
        assert_eq!(result(&path), expected, "cut at {cut}");
    }
}

#[test]
fn ctrl_c_keeps_points_names_command() {
    let folder = folder();
    let path = folder.path().join("stopped");
    let grid = ["sweep", "paper", "--vary", "half_backlash_um=0:150:0.05", "--out", text(&path)];
    let child = start(&grid);
    until("some points are kept", || lines(&journal(&path)) > 3);
    interrupt(&child);
    let ended = wait(child);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    for word in
        ["stopped by the user", "of 3001 points are left", "cargo joint sweep paper --vary half_backlash_um=0:150:0.05"]
    {
        assert!(ended.err.contains(word), "{word}: {ended:?}");
    }
    assert!(lines(&journal(&path)) > 3);
}

#[test]
fn full_disk_keeps_finished_points() {
    let folder = folder();
    // The limit has room for the description of the sweep, but not for the journal of 151 points.
    let grid = ["sweep", "paper", "--vary", "half_backlash_um=0:150:1", "--duration", "0.003", "--threads", "1"];
    let (expected, path) = (folder.path().join("whole"), folder.path().join("full"));
    joint(&[&grid[..], &["--out", text(&expected)]].concat()).succeeded();
    let arguments = [&grid[..], &["--out", text(&path)]].concat();
    joint_on_a_full_disk(12, &arguments).refused(&["cannot write", "free some space", "points of this run are kept"]);
    assert!(lines(&journal(&path)) > 20 && !path.join("points.csv").exists());
    let ended = joint(&arguments).succeeded();
    assert!(ended.err.contains("continuing:"), "{ended:?}");
    assert_eq!(result(&path), result(&expected));
}

#[test]
fn impossible_grid_writes_nothing() {
    let folder = folder();
    let path = folder.path().join("none");
    let refused = |vary: &[&str], words: &[&str]| {
        let vary: Vec<&str> = vary.iter().flat_map(|vary| ["--vary", vary]).collect();
        joint(&[&["sweep", "paper"], &vary[..], &["--out", text(&path)]].concat()).refused(words);
        assert!(!path.exists(), "{vary:?}");
    };
    refused(&[], &["--vary"]);
    refused(&["half_backlash_um=0:150:0"], &["never arrives"]);
    refused(&["half_backlash_um=0:150:-1"], &["no value", "0:150:1"]);
    refused(&["half_backlash_um=150:0:1"], &["no value", "150:0:-1"]);
    refused(&["half_backlash_um=0:150:NaN"], &["step is NaN"]);
    refused(&["half_backlash_um=0:inf:1"], &["to is inf"]);
    refused(&["half_backlash_um=0:1000:0.000000001"], &["1000000000001 values", "a step of"]);
    refused(&["half_backlash_um=0:100:0.0001", "mesh.damping_ratio=0:0.9:0.000001"], &["values on one axis"]);
    refused(
        &["half_backlash_um=0:100:0.001", "mesh.damping_ratio=0:0.9:0.00001"],
        &["100001 x 90001 = 9000190001 points", "coarser steps"],
    );
    refused(&["half_backlsh_um=0:150:1"], &["unknown key", "half_backlash_um"]);
    refused(&["half_backlash_um=0:1500:100"], &["between 0.5 and 1000", "1100"]);
    refused(&["half_backlash_um=1,2", "mesh.half_backlash_um=3,4"], &["varied twice"]);
    refused(&["half_backlash_um=1,2", "backlash_um=3,4"], &["has no effect"]);
    refused(&["half_backlash_um"], &["no `=`"]);
    let all = ["sweep", "paper", "--vary", "half_backlash_um=1,2", "--scheme", "all", "--out", text(&path)];
    joint(&all).refused(&["one scheme"]);
    let shard = ["sweep", "paper", "--vary", "half_backlash_um=1,2", "--shard", "5/4", "--out", text(&path)];
    joint(&shard).refused(&["5/4"]);
    joint(&["sweep", "/no/such.toml", "--vary", "half_backlash_um=1,2"]).refused(&["/no/such.toml"]);
    assert!(!path.exists());
}

#[test]
fn foreign_folder_rejected_unchanged() {
    let folder = folder();
    let path = folder.path().join("mine");
    fs::create_dir(&path).expect("room");
    for (name, words) in [("thesis.txt", "thesis.txt"), ("points.csv", "points.csv"), ("journal-1-of-1.csv", "journal")]
    {
        fs::write(path.join(name), "my data").expect("room");
        let before = contents(&path);
        sweep(&[], &path).refused(&["not a sweep's", words, "nothing was written"]);
        assert_eq!(contents(&path), before);
        fs::remove_file(path.join(name)).expect("it was there");
    }
    // A sweep's own folder with a foreign file.
    sweep(&[], &path).succeeded();
    fs::write(path.join("notes.txt"), "my data").expect("room");
    let before = contents(&path);
    sweep(&[], &path).refused(&["beside its sweep", "notes.txt"]);
    assert_eq!(contents(&path), before);
    joint(&["merge", text(&path)]).refused(&["beside its sweep", "notes.txt"]);
    assert_eq!(contents(&path), before);
    // A file in place of the folder.
    let file = folder.path().join("file");
    fs::write(&file, "my data").expect("room");
    sweep(&[], &file).refused(&["cannot make the folder"]);
    assert_eq!(fs::read_to_string(&file).expect("still there"), "my data");
}

#[test]
fn folder_of_other_sweep_rejected() {
    let folder = folder();
    let path = folder.path().join("sweep");
    sweep(&[], &path).succeeded();
    let before = contents(&path);
    let other = |arguments: &[&str], words: &[&str]| {
        joint(&[arguments, &["--out", text(&path)]].concat()).refused(words);
        assert_eq!(contents(&path), before, "{arguments:?}");
    };
    other(
        &["sweep", "paper", "--vary", "half_backlash_um=0:150:10", "--duration", "0.01"],
        &["another sweep", "grid", "0:150:5", "0:150:10"],
    );
    other(&[&GRID[..4], &["--duration", "0.02"]].concat(), &["another sweep", "motion"]);
    other(&[&GRID[..], &["--scheme", "rk4"]].concat(), &["another sweep", "scheme"]);
    other(&[&GRID[..], &["--set", "mesh.damping_ratio=0.06"]].concat(), &["another sweep", "joint file"]);
    other(&[&GRID[..], &["--metric", "period"]].concat(), &["another sweep", "metrics"]);
    // Shards of two sweeps do not merge.
    let second = folder.path().join("second");
    joint(&[&GRID[..], &["--scheme", "rk4", "--out", text(&second)]].concat()).succeeded();
    joint(&["merge", text(&path), text(&second)]).refused(&["another sweep than", "scheme"]);
}

#[test]
fn damaged_sweep_rejected_unchanged() {
    let folder = folder();
    let path = folder.path().join("sweep");
    sweep(&[], &path).succeeded();
    let manifest = fs::read_to_string(path.join("sweep.json")).expect("written");
    for spoilt in [manifest.replace("0:150:5", "0:150:6"), manifest[..100].to_owned(), String::new(), "\u{0}".into()] {
        fs::write(path.join("sweep.json"), &spoilt).expect("room");
        let before = contents(&path);
        sweep(&[], &path).refused(&["sweep.json is not a sweep's manifest"]);
        joint(&["merge", text(&path)]).refused(&["sweep.json is not a sweep's manifest"]);
        assert_eq!(contents(&path), before);
    }
    fs::write(path.join("sweep.json"), &manifest).expect("room");
    fs::write(journal(&path), "time,torque\n1,2\n").expect("room");
    let before = contents(&path);
    sweep(&[], &path).refused(&["is not the journal of a sweep"]);
    joint(&["merge", text(&path)]).refused(&["is not the journal of a sweep"]);
    assert_eq!(contents(&path), before);
    joint(&["merge", text(folder.path())]).refused(&["is not a sweep"]);
    joint(&["merge", "/no/such/folder"]).refused(&["/no/such/folder is not a folder"]);
}

#[test]
fn impossible_point_is_one_refused_row() {
    let folder = folder();
    let path = folder.path().join("some");
    // The joint file's own rules reject a motor limit below the drive torque.
    let grid = ["sweep", "q1", "--vary", "drive_torque_N_m=1,2,3", "--vary", "motor_torque_limit_N_m=5,2.5"];
    let ended = joint(&[&grid[..], &["--duration", "0.01", "--out", text(&path)]].concat()).succeeded();
    assert!(ended.err.contains("1 points were refused") && ended.err.contains("motor_torque_limit_N_m"), "{ended:?}");
    let result = result(&path);
    let status: Vec<&str> = result.lines().skip(1).filter_map(|line| line.split(',').nth(2)).collect();
    assert_eq!(status, ["ok", "ok", "ok", "ok", "ok", "refused"]);
    assert!(result.lines().nth(6).is_some_and(|line| line.starts_with("3,2.5,refused,,,")), "{result}");
}

#[test]
fn sweep_report_equal_from_shards() {
    let folder = folder();
    let page = |path: &Path| fs::read_to_string(path.join("report.html")).expect("a page");
    let whole = folder.path().join("whole");
    let ended = sweep(&[], &whole).succeeded();
    assert!(ended.out.contains("report: "), "{ended:?}");
    assert!(page(&whole).contains("Greatest mesh force") && page(&whole).contains("mesh.half_backlash_um"));
    // Shards, and a second run into the same folder, give equal bytes.
    let paths = ["1/2", "2/2"].map(|shard| {
        let path = folder.path().join(shard.replace('/', "-of-"));
        sweep(&["--shard", shard], &path).succeeded();
        assert!(!path.join("report.html").exists(), "not before all points are there");
        path
    });
    let [one, two] = paths.each_ref().map(text);
    let out = folder.path().join("merged");
    joint(&["merge", one, two, "--out", text(&out)]).succeeded();
    assert_eq!(page(&out), page(&whole));
    sweep(&[], &whole).succeeded();
    assert_eq!(page(&out), page(&whole));
}

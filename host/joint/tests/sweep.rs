//! `joint sweep` at the command line: equal bytes for any threads, engines, kills and order; foreign files stay
//! untouched; every error has its cause and remedy.

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

/// Folder of the tasks.
fn tasks(folder: &Path) -> PathBuf {
    folder.join("tasks")
}

/// Results of the tasks in a sweep's folder.
fn results(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(tasks(folder)).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "result"));
    paths.sort();
    paths
}

#[test]
fn threads_and_engines_give_equal_bytes() {
    let folder = folder();
    let expected = whole(folder.path());
    assert_eq!(expected.lines().count(), 32);
    for threads in ["1", "2", "7"] {
        let path = folder.path().join(threads);
        sweep(&["--threads", threads], &path).succeeded();
        assert_eq!(result(&path), expected, "{threads} threads");
    }
    // The elements of a job array each run one task, in any order and on any machine; the sweep collects them.
    let path = folder.path().join("array");
    let ended = sweep(&["--slurm"], &path).succeeded();
    assert!(ended.out.contains("31 tasks are left") && ended.out.contains("sbatch "), "{ended:?}");
    assert!(results(&path).is_empty() && !path.join("points.csv").exists());
    let script = fs::read_to_string(tasks(&path).join("slurm.sh")).expect("a script");
    assert!(script.contains("#SBATCH --array=0-30\n"), "{script}");
    for number in (0..31).rev().filter(|number| *number != 7) {
        joint(&["task", text(&tasks(&path)), "--number", &number.to_string()]).succeeded();
    }
    // The script names the tasks that are left.
    sweep(&["--slurm"], &path).succeeded();
    let script = fs::read_to_string(tasks(&path).join("slurm.sh")).expect("a script");
    assert!(script.contains("#SBATCH --array=7\n"), "{script}");
    let ended = sweep(&[], &path).succeeded();
    assert!(ended.err.contains("continuing: 30 of 31 tasks"), "{ended:?}");
    assert_eq!(result(&path), expected);
}

/// The job script runs as it stands; here a shell is the array's element. A program that is killed runs again.
#[test]
fn slurm_script_runs_its_task() {
    let folder = folder();
    let expected = whole(folder.path());
    let path = folder.path().join("of the array");
    sweep(&["--slurm"], &path).succeeded();
    let script = tasks(&path).join("slurm.sh");
    for number in 0..31 {
        let mut shell = std::process::Command::new("sh");
        let ended = shell.arg(&script).env("SLURM_ARRAY_TASK_ID", number.to_string()).output().expect("a shell");
        assert!(ended.status.success(), "{ended:?}");
    }
    assert_eq!(results(&path).len(), 31);
    let ended = sweep(&["--slurm"], &path).succeeded();
    assert!(ended.out.contains("every task has a result"), "{ended:?}");
    sweep(&[], &path).succeeded();
    assert_eq!(result(&path), expected);
}

/// A task computes the points from its list alone: a torque profile may be gone by then.
#[test]
fn task_needs_no_file_beside_its_list() {
    let folder = folder();
    let profile = folder.path().join("profile.csv");
    let rows = "time_s,motor_torque_Nm,load_torque_Nm\n0,0.5,2\n0.02,-0.5,-2\n";
    fs::write(&profile, rows).expect("room");
    let grid = ["sweep", "q1", "--vary", "half_backlash_um=20,30", "--duration", "0.05", "--profile", text(&profile)];
    let (one, other) = (folder.path().join("one"), folder.path().join("other"));
    joint(&[&grid[..], &["--out", text(&one)]].concat()).succeeded();
    joint(&[&grid[..], &["--slurm", "--out", text(&other)]].concat()).succeeded();
    fs::remove_file(&profile).expect("there");
    let elsewhere = folder.path().join("elsewhere");
    fs::create_dir(&elsewhere).expect("room");
    fs::copy(tasks(&other).join("list.json"), elsewhere.join("list.json")).expect("room");
    for number in ["0", "1"] {
        joint(&["task", text(&elsewhere), "--number", number]).succeeded();
    }
    assert_eq!(results(&one).len(), 2);
    for path in results(&one) {
        let name = path.file_name().expect("a name");
        assert_eq!(fs::read(elsewhere.join(name)).expect("a result"), fs::read(&path).expect("a result"));
    }
}

#[test]
fn removed_options_name_successor() {
    let folder = folder();
    let path = folder.path().join("old");
    sweep(&["--shard", "3/16"], &path).refused(&["--shard 3/16 was removed", "--slurm", "--dask"]);
    assert!(!path.exists());
    joint(&["merge", "node-1", "node-2", "--out", "all"])
        .refused(&["joint merge was removed", "the sweep's own command"]);
    sweep(&["--slurm", "--dask", "tcp://127.0.0.1:1"], &path).refused(&["cannot be used with"]);
    // The folder of a version with journals.
    sweep(&[], &path).succeeded();
    fs::write(path.join("journal-1-of-2.csv"), "joint-sweep,0\n").expect("room");
    let before = contents(&path);
    sweep(&[], &path).refused(&["journals of an older version", "journal-1-of-2.csv", "points.csv stays valid"]);
    assert_eq!(contents(&path), before);
}

#[test]
fn bad_task_names_remedy() {
    let folder = folder();
    let path = folder.path().join("sweep");
    sweep(&[], &path).succeeded();
    let task = |folder: &Path, number: &str| joint(&["task", text(folder), "--number", number]);
    task(&tasks(&path), "31").refused(&["no task 31", "its 31 tasks are numbered from 0"]);
    task(&path, "0").refused(&["cannot read the list of tasks", "--slurm"]);
    let list = tasks(&path).join("list.json");
    let whole = fs::read_to_string(&list).expect("a list");
    fs::write(&list, whole.replacen("0:150:5", "0:150:6", 1)).expect("room");
    task(&tasks(&path), "0").refused(&["an input does not have its digest", "run the command again"]);
    // The sweep writes its list anew and keeps the results.
    let ended = sweep(&[], &path).succeeded();
    assert!(ended.err.contains("continuing: 31 of 31"), "{ended:?}");
    assert_eq!(fs::read_to_string(&list).expect("a list"), whole);
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
        until("some points are kept", || results(&path).len() > wanted);
        child.kill().expect("it runs");
        wait(child);
    }
    let kept = results(&path).len();
    assert!((60..301).contains(&kept), "{kept}");
    assert!(!path.join("points.csv").exists());
    let ended = joint(&arguments).succeeded();
    assert!(ended.err.contains("continuing:"), "{ended:?}");
    assert_eq!(result(&path), expected);
}

#[test]
fn damaged_result_recomputed() {
    let folder = folder();
    let expected = whole(folder.path());
    let path = folder.path().join("whole");
    let file = results(&path).pop().expect("a result");
    let bytes = fs::read(&file).expect("a result");
    let altered = String::from_utf8_lossy(&bytes).replace(",ok,", ",diverged,").into_bytes();
    for spoilt in [&bytes[..bytes.len() - 1], &bytes[..bytes.len() / 2], &bytes[..0], &altered] {
        fs::write(&file, spoilt).expect("room");
        fs::remove_file(path.join("points.csv")).expect("it was there");
        sweep(&[], &path).succeeded();
        assert_eq!(result(&path), expected);
        assert_eq!(fs::read(&file).expect("a result"), bytes);
    }
}

#[test]
fn ctrl_c_keeps_points_names_command() {
    let folder = folder();
    let path = folder.path().join("stopped");
    let grid = ["sweep", "paper", "--vary", "half_backlash_um=0:150:0.05", "--out", text(&path)];
    let child = start(&grid);
    until("some points are kept", || results(&path).len() > 3);
    interrupt(&child);
    let ended = wait(child);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    for word in
        ["stopped by the user", "of 751 tasks are left", "cargo joint sweep paper --vary half_backlash_um=0:150:0.05"]
    {
        assert!(ended.err.contains(word), "{word}: {ended:?}");
    }
    assert!(results(&path).len() > 3);
}

#[test]
fn full_disk_keeps_finished_points() {
    let folder = folder();
    // The limit has room for the results of the tasks, but not for the result of 151 points.
    let grid = ["sweep", "paper", "--vary", "half_backlash_um=0:150:1", "--duration", "0.003", "--threads", "1"];
    let (expected, path) = (folder.path().join("whole"), folder.path().join("full"));
    joint(&[&grid[..], &["--out", text(&expected)]].concat()).succeeded();
    let arguments = [&grid[..], &["--out", text(&path)]].concat();
    let size = fs::metadata(tasks(&expected).join("list.json")).expect("a list").len();
    let limit = u32::try_from(size / 1024).expect("small");
    joint_on_a_full_disk(limit, &arguments).refused(&["cannot write", "list.json", "free some space"]);
    assert!(results(&path).is_empty() && !path.join("points.csv").exists());
    joint(&arguments).succeeded();
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
    joint(&["sweep", "/no/such.toml", "--vary", "half_backlash_um=1,2"]).refused(&["/no/such.toml"]);
    assert!(!path.exists());
}

#[test]
fn foreign_folder_rejected_unchanged() {
    let folder = folder();
    let path = folder.path().join("mine");
    fs::create_dir(&path).expect("room");
    for (name, words) in [("thesis.txt", "thesis.txt"), ("points.csv", "points.csv"), ("tasks", "tasks")] {
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
        assert_eq!(contents(&path), before);
    }
    fs::write(path.join("sweep.json"), &manifest).expect("room");
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
fn sweep_report_equal_from_tasks() {
    let folder = folder();
    let page = |path: &Path| fs::read_to_string(path.join("report.html")).expect("a page");
    let whole = folder.path().join("whole");
    let ended = sweep(&[], &whole).succeeded();
    assert!(ended.out.contains("report: "), "{ended:?}");
    assert!(page(&whole).contains("Greatest mesh force") && page(&whole).contains("mesh.half_backlash_um"));
    // Tasks of an array, and a second run into the same folder, give equal bytes.
    let out = folder.path().join("array");
    sweep(&["--slurm"], &out).succeeded();
    (0..31).for_each(|number| {
        joint(&["task", text(&tasks(&out)), "--number", &number.to_string()]).succeeded();
    });
    assert!(!out.join("report.html").exists(), "not before the results are collected");
    sweep(&[], &out).succeeded();
    assert_eq!(page(&out), page(&whole));
    sweep(&[], &whole).succeeded();
    assert_eq!(page(&out), page(&whole));
}

//! A command killed at any moment leaves no partial file under a final name. Running the command again gives the
//! results of an undisturbed run and removes the leftovers.
//!
//! Seen to fail: with results written in parts under their final names, every command has a kill that leaves a partial
//! file.
//!
//! The short run has fixed seeds; `KILLS=1000` kills each command that often, from a printed seed that `KILLS_SEED`
//! repeats.

use std::path::Path;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use host_tests::extent::cases;
use scenario::random::RandomStream;

use crate::command::{folder, start, wait};
use crate::tree::{Tree, WRITTEN_LIST, assert_same, is_equal, results, tree};
use crate::writers::{Writer, empty_folder};

/// Kills of each command in the short run, and of each slow command.
const KILLS: u32 = 6;
const SLOW_KILLS: u32 = 1;

fn variable(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().unwrap_or_else(|_| panic!("{name}={value} is no whole number")))
}

/// Kills of each command, and the seed of their times.
fn extent(writer: Writer) -> (u32, u64) {
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    match variable("KILLS") {
        None => (if writer.is_slow() { SLOW_KILLS } else { KILLS }, variable("KILLS_SEED").unwrap_or(1)),
        Some(kills) => (kills as u32, variable("KILLS_SEED").unwrap_or_else(now)),
    }
}

/// Returns true for the name of an unfinished file, which is no result.
fn is_unfinished(name: &str) -> bool {
    let last = name.rsplit('/').next().unwrap_or(name);
    let temporary = last.starts_with('.') && last.contains(".joint-") && last.ends_with(".tmp");
    temporary || last == WRITTEN_LIST || last.starts_with("history.partial.")
}

fn assert_no_partial_file(writer: Writer, left: &Tree, whole: &Tree, when: &str) {
    for (name, bytes) in left.iter().filter(|(name, _)| !is_unfinished(name)) {
        let expected = whole.get(name).unwrap_or_else(|| panic!("{when}: {name} is no file of a whole run"));
        assert!(is_equal(writer, name, bytes, expected), "{when}: {name} is half written");
    }
}

/// Runs a command and kills it after a time; returns true if it was still running.
fn run_and_kill(writer: Writer, out: &Path, after: Duration) -> bool {
    let line = writer.line(out);
    let mut child = start(&line.words());
    std::thread::sleep(after);
    child.kill().expect("it was started here");
    wait(child).code.is_none()
}

fn check_kills(writer: Writer) {
    let (kills, seed) = extent(writer);
    println!("{writer:?}: {kills} kills, KILLS_SEED={seed}");
    let mut stream = RandomStream::new(seed, &format!("{writer:?}"));
    let place = folder();
    let out = empty_folder(place.path());
    if !writer.is_slow() {
        // The first run loads system files that later runs find cached.
        writer.run(&out).succeeded();
    }
    let out = empty_folder(place.path());
    let begin = Instant::now();
    writer.run(&out).succeeded();
    let mut duration = begin.elapsed();
    let whole = results(tree(&out));
    let mut interrupted = 0;
    // If the machine has become faster, the runs end before the kill: try more often, earlier.
    for kill in 0..3 * kills {
        if interrupted == kills {
            break;
        }
        // Half of the runs start in an empty folder, half over a complete run.
        let out =
            if kill % 2 == 0 || writer.writes_once().is_some() { empty_folder(place.path()) } else { out.clone() };
        let after = duration.mul_f64(1.05 * stream.uniform());
        let when = format!("{writer:?}, kill {kill}, after {after:?}, KILLS_SEED={seed}");
        match run_and_kill(writer, &out, after) {
            true => interrupted += 1,
            false => duration = duration.mul_f64(0.8),
        }
        let left = tree(&out);
        assert_no_partial_file(writer, &left, &whole, &when);
        assert!(
            left.len() != 1 || !left.contains_key(WRITTEN_LIST),
            "{when}: nothing is left but the list of what was written"
        );
        if !writer.writes_once().is_some_and(|file| out.join(file).exists()) {
            let ended = writer.run(&out);
            assert_eq!(ended.code, Some(0), "{when}: {ended:?}");
        }
        assert_same(writer, &results(tree(&out)), &whole, &when);
    }
    assert!(interrupted > 0, "{writer:?}: none of the kills came before the end");
}

#[test]
fn killed_sim_leaves_no_partial_file() {
    check_kills(Writer::Sim);
}

#[test]
fn killed_sweep_leaves_no_partial_file() {
    check_kills(Writer::Sweep);
}

#[test]
fn killed_tests_leave_no_partial_file() {
    check_kills(Writer::Tests);
}

#[test]
fn killed_board_run_leaves_no_partial_file() {
    check_kills(Writer::Board);
}

#[test]
fn killed_identify_leaves_no_partial_file() {
    check_kills(Writer::Identify);
}

#[test]
fn killed_quasi_static_leaves_no_partial_file() {
    check_kills(Writer::SlowLog);
}

#[test]
fn killed_recording_leaves_no_partial_file() {
    check_kills(Writer::Simulate);
}

#[test]
fn killed_new_leaves_no_partial_file() {
    check_kills(Writer::New);
    check_kills(Writer::Tables);
}

#[test]
fn killed_json_is_complete_or_absent() {
    // Both commands write their record by the same function.
    cases(&[Writer::Check, Writer::Budget], 1).iter().for_each(|writer| check_kills(*writer));
}

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

use scenario::random::RandomStream;

use crate::command::{folder, start, wait};
use crate::tree::{LIST, Tree, assert_same, results, say_the_same, tree};
use crate::writers::{Writer, empty};

/// Kills of each command in the short run, and of each slow command.
const KILLS: u32 = 6;
const SLOW_KILLS: u32 = 1;

fn asked(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().unwrap_or_else(|_| panic!("{name}={value} is no whole number")))
}

/// Kills of each command, and the seed of their times.
fn extent(writer: Writer) -> (u32, u64) {
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    match asked("KILLS") {
        None => (if writer.is_slow() { SLOW_KILLS } else { KILLS }, asked("KILLS_SEED").unwrap_or(1)),
        Some(kills) => (kills as u32, asked("KILLS_SEED").unwrap_or_else(now)),
    }
}

/// Returns true for the name of an unfinished file, which is no result.
fn is_unfinished(name: &str) -> bool {
    let last = name.rsplit('/').next().unwrap_or(name);
    let temporary = last.starts_with('.') && last.contains(".joint-") && last.ends_with(".tmp");
    // A journal is valid up to its last complete line, and the next run continues it.
    temporary || last == LIST || last.starts_with("history.partial.") || last.starts_with("journal-")
}

fn assert_none_is_half_written(writer: Writer, left: &Tree, whole: &Tree, when: &str) {
    for (name, bytes) in left.iter().filter(|(name, _)| !is_unfinished(name)) {
        let expected = whole.get(name).unwrap_or_else(|| panic!("{when}: {name} is no file of a whole run"));
        assert!(say_the_same(writer, name, bytes, expected), "{when}: {name} is half written");
    }
}

/// Runs a command and kills it after a time; returns true if it was still running.
fn killed(writer: Writer, out: &Path, after: Duration) -> bool {
    let line = writer.line(out);
    let mut child = start(&line.words());
    std::thread::sleep(after);
    child.kill().expect("it was started here");
    wait(child).code.is_none()
}

fn is_killed_at_any_moment(writer: Writer) {
    let (kills, seed) = extent(writer);
    println!("{writer:?}: {kills} kills, KILLS_SEED={seed}");
    let mut stream = RandomStream::new(seed, &format!("{writer:?}"));
    let place = folder();
    let out = empty(place.path());
    if !writer.is_slow() {
        // The first run loads system files that later runs find cached.
        writer.run(&out).well();
    }
    let out = empty(place.path());
    let begin = Instant::now();
    writer.run(&out).well();
    let mut long = begin.elapsed();
    let whole = results(tree(&out));
    let mut amidst = 0;
    // If the machine has become faster, the runs end before the kill: try more often, earlier.
    for kill in 0..3 * kills {
        if amidst == kills {
            break;
        }
        // Half of the runs start in an empty folder, half over a complete run.
        let out = if kill % 2 == 0 || writer.writes_once().is_some() { empty(place.path()) } else { out.clone() };
        let after = long.mul_f64(1.05 * stream.uniform());
        let when = format!("{writer:?}, kill {kill}, after {after:?}, KILLS_SEED={seed}");
        match killed(writer, &out, after) {
            true => amidst += 1,
            false => long = long.mul_f64(0.8),
        }
        let left = tree(&out);
        assert_none_is_half_written(writer, &left, &whole, &when);
        assert!(
            left.len() != 1 || !left.contains_key(LIST),
            "{when}: nothing is left but the list of what was written"
        );
        if !writer.writes_once().is_some_and(|file| out.join(file).exists()) {
            let ended = writer.run(&out);
            assert_eq!(ended.code, Some(0), "{when}: {ended:?}");
        }
        assert_same(writer, &results(tree(&out)), &whole, &when);
    }
    assert!(amidst > 0, "{writer:?}: none of the kills came before the end");
}

#[test]
fn a_killed_simulation_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::Sim);
}

#[test]
fn a_killed_sweep_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::Sweep);
    is_killed_at_any_moment(Writer::Merge);
}

#[test]
fn killed_tests_leave_nothing_half_written() {
    is_killed_at_any_moment(Writer::Tests);
}

#[test]
fn a_killed_run_on_a_board_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::Board);
}

#[test]
fn a_killed_identification_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::Identify);
}

#[test]
fn a_killed_reading_of_slow_sweeps_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::SlowLog);
}

#[test]
fn a_killed_recording_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::Simulate);
}

#[test]
fn a_killed_new_joint_leaves_nothing_half_written() {
    is_killed_at_any_moment(Writer::New);
    is_killed_at_any_moment(Writer::Tables);
}

#[test]
fn killed_figures_as_json_are_whole_or_not_there() {
    is_killed_at_any_moment(Writer::Check);
    is_killed_at_any_moment(Writer::Budget);
}

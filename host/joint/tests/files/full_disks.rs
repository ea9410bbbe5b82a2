//! On a full disk every command names the file and the cause, preserves existing files, and reports every file that it
//! leaves. A limit on the size of files simulates the full disk: it works for every user and at any size.

use std::fs;
use std::path::Path;

use crate::command::{Ended, folder, joint_on_a_full_disk_with, text};
use crate::tree::{LIST, Tree, assert_same, results, say_the_same, tree};
use crate::writers::{Writer, empty};

/// Limits on the size of a file [KiB]; the last one has room for every file.
const LIMITS: [u32; 8] = [0, 1, 2, 4, 16, 64, 256, 1 << 16];
/// Limits for slow commands [KiB].
const SLOW_LIMITS: [u32; 1] = [64];

/// Asserts that a folder holds only earlier files, complete files, and partial files that the error message names.
fn assert_all_is_told(writer: Writer, left: &Tree, whole: &Tree, ended: &Ended, when: &str) {
    for (name, bytes) in left {
        // The log of a board may be empty.
        assert!(!bytes.is_empty() || name == "log.txt", "{when}: {name} is empty: {ended:?}");
        // A journal is valid up to its last complete line.
        if name == LIST || name.starts_with("journal-") {
            continue;
        }
        if name.contains(".partial.") {
            assert!(ended.err.contains(name.as_str()), "{when}: {name} is not told: {ended:?}");
            continue;
        }
        if is_a_whole_result_that_tells(name, bytes) {
            continue;
        }
        let expected = whole.get(name).unwrap_or_else(|| panic!("{when}: {name} is left behind: {ended:?}"));
        assert!(say_the_same(writer, name, bytes, expected), "{when}: {name} is half written");
    }
}

/// Returns true for a complete result that reports a failed write: a test without room for its log states so in the
/// results.
fn is_a_whole_result_that_tells(name: &str, bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let whole = match name.rsplit('.').next() {
        Some("json") => serde_json::from_str::<serde_json::Value>(&text).is_ok(),
        Some("xml") => text.trim_end().ends_with("</testsuites>"),
        _ => text.trim_end().ends_with("</html>"),
    };
    whole && text.contains("cannot write")
}

fn finds_no_room(writer: Writer) {
    let place = folder();
    let out = empty(place.path());
    writer.run(&out).well();
    let whole = results(tree(&out));
    // First in an empty folder, then over a complete run.
    let slow = writer.is_slow();
    let states: &[bool] = match writer {
        _ if writer.writes_once().is_some() => &[false],
        _ if slow => &[true],
        _ => &[false, true],
    };
    for &older in states {
        let mut refusals = 0;
        for limit in if slow { &SLOW_LIMITS[..] } else { &LIMITS } {
            let out = if older { out.clone() } else { empty(place.path()) };
            let when = format!("{writer:?}, {limit} KiB, older run: {older}");
            let second = folder();
            let temporary = [("TMPDIR", text(second.path()))];
            let ended = joint_on_a_full_disk_with(*limit, &writer.line(&out).words(), &temporary);
            if ended.code == Some(0) {
                break;
            }
            assert!(*limit < LIMITS[LIMITS.len() - 1], "{when}: {ended:?}");
            refusals += 1;
            // A record of a board has no fixed length; if it found room in the second place, the message gives the
            // path.
            let kept = writer == Writer::Board && count(second.path()) > 0;
            let help = if kept { text(second.path()) } else { "free some space" };
            ended.refused(&["cannot write", text(&out), help]);
            assert_all_is_told(writer, &tree(&out), &whole, &ended, &when);
            if older {
                assert!(whole.keys().all(|name| tree(&out).contains_key(name)), "{when}: what was there is there");
            }
            if !slow {
                let again = writer.run(&out);
                assert_eq!(again.code, Some(0), "{when}: {again:?}");
                assert_same(writer, &results(tree(&out)), &whole, &when);
            }
        }
        assert!(refusals > 0, "{writer:?} has found room everywhere");
    }
}

#[test]
fn every_writer_to_a_folder_finds_no_room() {
    Writer::TO_FOLDERS.into_iter().for_each(finds_no_room);
}

#[test]
fn every_writer_to_a_file_finds_no_room() {
    for writer in [Writer::Simulate, Writer::Check, Writer::Budget, Writer::New] {
        finds_no_room(writer);
    }
}

/// A measurement cannot be repeated, so the record is also tried in a second place. If that place is full too, no file
/// stays there.
#[test]
fn a_run_on_a_board_leaves_no_empty_second_place() {
    let place = folder();
    let (out, second) = (empty(place.path()), place.path().join("second"));
    fs::create_dir(&second).expect("room");
    let line = Writer::Board.line(&out);
    let ended = joint_on_a_full_disk_with(1, &line.words(), &[("TMPDIR", text(&second))]);
    ended.refused(&["cannot write", text(&out), "free some space"]);
    assert_eq!(count(&second), 0, "{ended:?}");
}

fn count(folder: &Path) -> usize {
    fs::read_dir(folder).expect("a folder").count()
}

//! On a full disk every command ends with the file and the reason, loses nothing that was there, and leaves nothing that it
//! does not tell. A limit on the size of files is the disk: it works for every user, and at any size.

use std::fs;
use std::path::Path;

use crate::command::{Ended, folder, joint_on_a_full_disk_with, text};
use crate::tree::{LIST, Tree, assert_same, results, say_the_same, tree};
use crate::writers::{Writer, empty};

/// Limits on the size of a file [KiB]; in the last every file of these has room.
const LIMITS: [u32; 8] = [0, 1, 2, 4, 16, 64, 256, 1 << 16];
/// That for what is slow.
const SLOW_LIMITS: [u32; 1] = [64];

/// What is left of a run that found no room: files of before, whole ones, and what it tells.
fn assert_all_is_told(writer: Writer, left: &Tree, whole: &Tree, ended: &Ended, when: &str) {
    for (name, bytes) in left {
        // A board may have nothing to log.
        assert!(!bytes.is_empty() || name == "log.txt", "{when}: {name} is empty: {ended:?}");
        // A journal is whole up to its last line.
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

/// Results of tests of which one had no room for its log say so, as they say everything that kept a test from running.
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
    // Once with nothing in the folder, once with a whole run.
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
            // What had room for its record, which is of no fixed length, says where that is.
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

/// What cannot be measured again is tried in a second place; where that is full too nothing is left there either.
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

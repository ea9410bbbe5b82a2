//! On a full disk every command names the file and the cause, preserves existing files, and reports every file that it
//! leaves. A limit on the size of files simulates the full disk: it works for every user and at any size.

use std::fs;
use std::path::Path;

use host_tests::extent::{cases, short_or_long};

use crate::command::{Ended, folder, joint_on_a_full_disk_with, text};
use crate::tree::{Tree, WRITTEN_LIST, assert_same, is_equal, results, tree};
use crate::writers::{Writer, empty_folder};

/// Limits on the size of a file [KiB]; the last one has room for every file.
const LIMITS: [u32; 8] = [0, 1, 2, 4, 16, 64, 256, 1 << 16];
/// Limits of the short form: no room, room for a part of a file, room for every file [KiB].
const SHORT_LIMITS: [u32; 3] = [0, 16, 1 << 16];
/// Limits for slow commands [KiB].
const SLOW_LIMITS: [u32; 1] = [64];

/// Asserts that a folder holds only earlier files, complete files, and partial files that the error message names.
fn assert_rest_is_reported(writer: Writer, left: &Tree, whole: &Tree, ended: &Ended, when: &str) {
    for (name, bytes) in left {
        // The log of a board may be empty.
        assert!(!bytes.is_empty() || name == "log.txt", "{when}: {name} is empty: {ended:?}");
        if name == WRITTEN_LIST {
            continue;
        }
        if name.contains(".partial.") {
            assert!(ended.err.contains(name.as_str()), "{when}: {name} is not told: {ended:?}");
            continue;
        }
        if is_complete_with_write_error(name, bytes) {
            continue;
        }
        let expected = whole.get(name).unwrap_or_else(|| panic!("{when}: {name} is left behind: {ended:?}"));
        assert!(is_equal(writer, name, bytes, expected), "{when}: {name} is half written");
    }
}

/// Returns true for a complete result that reports a failed write: a test without room for its log states so in the
/// results.
fn is_complete_with_write_error(name: &str, bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let whole = match name.rsplit('.').next() {
        Some("json") => serde_json::from_str::<serde_json::Value>(&text).is_ok(),
        Some("xml") => text.trim_end().ends_with("</testsuites>"),
        _ => text.trim_end().ends_with("</html>"),
    };
    whole && text.contains("cannot write")
}

fn check_full_disk(writer: Writer) {
    let place = folder();
    let out = empty_folder(place.path());
    writer.run(&out).succeeded();
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
        for limit in if slow { &SLOW_LIMITS[..] } else { short_or_long(&SHORT_LIMITS[..], &LIMITS) } {
            let out = if older { out.clone() } else { empty_folder(place.path()) };
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
            assert_rest_is_reported(writer, &tree(&out), &whole, &ended, &when);
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
#[ignore = "half a minute and more: .ci/attack"]
fn full_disk_every_folder_writer() {
    Writer::TO_FOLDERS.into_iter().for_each(check_full_disk);
}

#[test]
fn full_disk_every_file_writer() {
    for writer in cases(&[Writer::Simulate, Writer::Check, Writer::New, Writer::Budget], 3) {
        check_full_disk(*writer);
    }
}

/// A measurement cannot be repeated, so the record is also tried in a second place. If that place is full too, no file
/// stays there.
#[test]
fn full_second_place_left_empty() {
    let place = folder();
    let (out, second) = (empty_folder(place.path()), place.path().join("second"));
    fs::create_dir(&second).expect("room");
    let line = Writer::Board.line(&out);
    let ended = joint_on_a_full_disk_with(1, &line.words(), &[("TMPDIR", text(&second))]);
    ended.refused(&["cannot write", text(&out), "free some space"]);
    assert_eq!(count(&second), 0, "{ended:?}");
}

fn count(folder: &Path) -> usize {
    fs::read_dir(folder).expect("a folder").count()
}

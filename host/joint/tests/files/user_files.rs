//! The user's own files in the folder of `--out` are never overwritten: the command rejects the folder before it works.

use std::fs;

use crate::command::{folder, joint, text};
use crate::tree::{WRITTEN_LIST, results, tree};
use crate::writers::{Writer, empty_folder};

/// Files of an interrupted run.
const PARTIAL_FILES: [&str; 2] = ["history.partial.csv", "history.partial.mcap"];

/// Names of all files that a command may write to a folder.
fn names(writer: Writer) -> Vec<String> {
    let place = folder();
    let out = empty_folder(place.path());
    writer.run(&out).succeeded();
    writer.run(&out).succeeded();
    let mut names: Vec<String> = results(tree(&out)).into_keys().collect();
    assert!(!names.is_empty());
    if writer == Writer::Sim {
        names.extend(PARTIAL_FILES.map(String::from));
    }
    names
}

#[test]
fn foreign_file_never_overwritten() {
    for writer in Writer::TO_FOLDERS {
        for name in names(writer) {
            let place = folder();
            let out = empty_folder(place.path());
            let path = out.join(&name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("room");
            fs::write(&path, "my thesis").expect("room");
            fs::write(out.join(".notes"), "mine too").expect("room");
            let before = tree(&out);
            let ended = writer.run(&out);
            // A sweep needs a folder of its own and rejects any other entry.
            let named = match writer {
                Writer::Sweep => name.split('/').next().unwrap_or(&name),
                _ => &name,
            };
            let why = match writer {
                Writer::Sweep if name == "sweep.json" => "is not a sweep's manifest",
                Writer::Sweep => "holds files that are not a sweep's",
                _ => "was not written by this command and would be lost",
            };
            ended.refused(&[named, why, "--out DIR"]);
            assert_eq!(tree(&out), before, "{writer:?}, {name}: it is left as it is, and nothing was written");
        }
    }
}

#[test]
fn changed_result_never_overwritten() {
    for writer in Writer::TO_FOLDERS {
        let place = folder();
        let out = empty_folder(place.path());
        writer.run(&out).succeeded();
        let before = tree(&out);
        // Files that a sweep reads back are checked by their content, in its own tests.
        let read = |name: &str| name == "sweep.json" || name.starts_with("tasks/");
        for (name, bytes) in before.iter().filter(|(name, _)| *name != WRITTEN_LIST && !read(name)) {
            let changed = [bytes, "my note\n".as_bytes()].concat();
            fs::write(out.join(name), &changed).expect("room");
            writer.run(&out).refused(&[name, "has been changed since this command wrote it", "--out DIR"]);
            let mut expected = before.clone();
            expected.insert(name.clone(), changed);
            assert_eq!(tree(&out), expected, "{writer:?}, {name}: it is left as it is, and nothing was written");
            fs::write(out.join(name), bytes).expect("room");
        }
        writer.run(&out).succeeded();
    }
}

#[test]
fn unrelated_file_is_left_alone() {
    for writer in Writer::TO_FOLDERS.into_iter().filter(|writer| *writer != Writer::Sweep) {
        let place = folder();
        let out = empty_folder(place.path());
        fs::write(out.join("notes.txt"), "mine").expect("room");
        writer.run(&out).succeeded();
        writer.run(&out).succeeded();
        assert_eq!(fs::read_to_string(out.join("notes.txt")).expect("still there"), "mine");
    }
}

/// The list of written files holds no absolute paths.
#[test]
fn moved_folder_is_recognized() {
    let place = folder();
    let out = empty_folder(place.path());
    Writer::Sim.run(&out).succeeded();
    let moved = place.path().join("moved");
    fs::rename(&out, &moved).expect("the same disk");
    Writer::Sim.run(&moved).succeeded();
}

#[test]
fn foreign_log_among_runs_kept() {
    let place = folder();
    let out = empty_folder(place.path());
    Writer::Tests.run(&out).succeeded();
    fs::write(out.join("runs/mine.mcap"), "recorded on the bench").expect("room");
    let before = tree(&out);
    Writer::Tests.run(&out).refused(&["mine.mcap was not written by this command"]);
    assert_eq!(tree(&out), before);
}

/// A long command rejects the folder as quickly as a short one.
#[test]
fn rejection_precedes_work() {
    let place = folder();
    fs::write(place.path().join("history.csv"), "mine").expect("room");
    let start = std::time::Instant::now();
    joint(&["sim", "l1", "--duration", "3600", "--every", "1000", "--out", text(place.path())])
        .refused(&["history.csv was not written by this command"]);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

//! All files of a folder and its subfolders.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use report_diff::{Options, compare};

use crate::writers::Writer;

/// List of the files in a folder that the command has written.
pub const WRITTEN_LIST: &str = ".written-by-joint";

/// Contents by path.
pub type Tree = BTreeMap<String, Vec<u8>>;

/// Reads all files below a folder, hidden files too.
pub fn tree(folder: &Path) -> Tree {
    let mut found = Tree::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(tree(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.insert(name, fs::read(&path).expect("a file"));
        }
    }
    found
}

/// Removes the list from a tree.
pub fn results(mut tree: Tree) -> Tree {
    tree.remove(WRITTEN_LIST);
    tree
}

/// Returns true if two files of a writer are equal except for dates and similar entries.
pub fn is_equal(writer: Writer, name: &str, one: &[u8], other: &[u8]) -> bool {
    if one == other {
        return true;
    }
    if writer == Writer::Board {
        return is_equal_for_board(name, one, other);
    }
    let place = tempfile::tempdir().expect("a folder");
    let [old, new] = [("old", one), ("new", other)].map(|(side, bytes)| {
        let path = place.path().join(side).join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("room");
        fs::write(&path, bytes).expect("room");
        path
    });
    compare(&old, &new, Options::default()).is_ok_and(|found| found.is_same())
}

/// Compares files of a board. Its clock makes the times differ: motion and completeness must be equal, and the page
/// complete.
fn is_equal_for_board(name: &str, one: &[u8], other: &[u8]) -> bool {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let value = |bytes: &[u8], key: &str| Some(serde_json::from_slice::<serde_json::Value>(bytes).ok()?[key].clone());
    match name {
        "record.json" => ["samples", "completeness"]
            .iter()
            .all(|key| value(one, key).is_some_and(|found| Some(found) == value(other, key))),
        "report.html" => text(one).trim_end().ends_with("</html>"),
        _ => true,
    }
}

/// Asserts that two trees have the same files with equal contents.
#[track_caller]
pub fn assert_same(writer: Writer, found: &Tree, expected: &Tree, when: &str) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{when}");
    for (name, bytes) in found {
        assert!(is_equal(writer, name, bytes, &expected[name]), "{when}: {name} says something else");
    }
}

//! Packages of other languages for tests, kept below the build directory until their list changes.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder `name` below `all` with the packages of a list. `install` fills it if the list changed or if `part` of it is
/// missing.
pub fn packages(all: &Path, name: &str, list: &Path, part: &str, install: impl FnOnce(&Path)) -> PathBuf {
    let folder = all.join(name);
    fs::create_dir_all(&folder).expect("the build directory is writable");
    // One installation at a time, across the threads and processes that share the folder.
    let lock = File::create(all.join("lock")).expect("the build directory is writable");
    lock.lock().expect("a lock on a file of ours");
    let wanted = fs::read(list).expect("a list of pinned packages");
    let stamp = folder.join("installed.txt");
    if !fs::read(&stamp).is_ok_and(|installed| installed == wanted) || !folder.join(part).exists() {
        install(&folder);
        fs::write(&stamp, wanted).expect("the build directory is writable");
    }
    folder
}

/// Python interpreter with the packages of the list `NAME.txt` in a folder, below `all`.
pub fn python(all: &Path, lists: &Path, name: &str) -> PathBuf {
    let list = lists.join(format!("{name}.txt"));
    let python = |place: &Path| place.join("bin/python");
    let install = |place: &Path| {
        succeeded(Command::new("python3").args(["-m", "venv", "--clear"]).arg(place));
        let pip = ["-m", "pip", "install", "--quiet", "--no-deps", "--requirement"];
        succeeded(Command::new(python(place)).args(pip).arg(&list));
    };
    python(&packages(all, name, &list, "bin/python", install))
}

/// Standard output of a process that must succeed; panics with all of its output if it fails.
pub fn succeeded(command: &mut Command) -> String {
    let ended = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let [out, said] = [&ended.stdout, &ended.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(ended.status.success(), "{command:?}:\n{out}{said}");
    out
}

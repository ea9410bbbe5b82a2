//! Ownership of the files in a folder. A list in the folder has a line with the SHA-256 of every file that a command
//! has written there. A file is the command's own if its content still matches a line; files that the user added or
//! changed do not match. The line is written before the file gets its name, so a kill in between leaves no unlisted
//! file. The list is created with its first line: a run that is killed before it writes anything leaves no list.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use sha2::{Digest, Sha256};

use crate::digest::hexadecimal;
use crate::failure::{Failure, Outcome};
use crate::write::{locked, try_to_write, write_failure};

/// Name of the list, hidden since it is no result.
pub const LIST_NAME: &str = ".written-by-joint";
/// First line of the list.
const LIST_HEADER: &str = "# files that joint has written here, each with its SHA-256; it never writes over any other";
/// Entry in place of a digest: the file grows during a run and is owned until it is complete.
const GROWING: &str = "growing";
/// Entry in place of a digest: the file has finished growing.
const GROWN: &str = "grown";

/// List of a folder.
#[derive(Debug)]
pub struct OwnFiles {
    folder: PathBuf,
    list: Mutex<List>,
}

#[derive(Debug, Default)]
struct List {
    digests: BTreeMap<String, BTreeSet<String>>,
    growing: BTreeSet<String>,
    /// Names that this run has written.
    written: BTreeSet<String>,
    /// True while the folder is written to and lines are added on disk.
    is_open: bool,
    /// Lock of the folder, held while this run is its only writer.
    _lock: Option<File>,
}

/// Number of simultaneous writers to a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Writers {
    /// One run, since the files of two would mix.
    One,
    /// Several runs with files of their own, such as those that share the tasks of a sweep.
    Several,
}

/// Owner of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// Written by a command, and unchanged.
    Ours,
    /// Written by a command, and changed since.
    Changed,
    /// Not written by a command.
    Foreign,
}

impl OwnFiles {
    /// Reads the list of a folder, if there is one; writes nothing.
    pub fn read(folder: &Path) -> Outcome<Self> {
        let text = read_list(&folder.join(LIST_NAME)).map_err(|error| list_error(folder, &error))?;
        if !is_partial_header(&text) && !has_header(&text) {
            return Err(list_error(folder, &"joint has not written it"));
        }
        Ok(Self { folder: folder.to_owned(), list: Mutex::new(List::parse(&text)) })
    }

    /// Reads the current list from disk and makes the folder ready for writing; an unwritable folder is reported here.
    /// The folder stays locked until this value is dropped or the process ends.
    pub fn open(&self, writers: Writers) -> Outcome<()> {
        let path = self.folder.join(LIST_NAME);
        let open = || {
            // A folder that cannot be opened or locked, as on some file systems, can still be written to.
            let lock = File::open(&self.folder).ok().filter(|_| writers == Writers::One);
            if lock.as_ref().is_some_and(|folder| !locked(folder)) {
                return Ok(None);
            }
            try_to_write(&path, LIST_HEADER.as_bytes())?;
            let text = read_list(&path)?;
            let is_empty = is_partial_header(&text) || text == LIST_HEADER;
            if writers == Writers::One && is_empty && path.exists() {
                // A killed run has left a list without entries.
                fs::remove_file(&path)?;
            }
            Ok(Some((lock, text)))
        };
        let opened = open().map_err(|error: io::Error| write_failure(&path, &error))?;
        let Some((lock, text)) = opened else {
            return Err(Failure::new(format!("another run is writing to {}", self.folder.display()))
                .with_help("let it finish, or name another folder by --out DIR"));
        };
        *self.list() = List { is_open: true, _lock: lock, ..List::parse(&text) };
        Ok(())
    }

    /// Owner of a file in the folder.
    pub fn owner(&self, name: &str) -> Owner {
        let list = self.list();
        if list.growing.contains(&key(name)) {
            return Owner::Ours;
        }
        let Some(digests) = list.digests.get(&key(name)) else { return Owner::Foreign };
        let path = self.folder.join(name);
        // Only regular files are read: a pipe would never end.
        let file = fs::metadata(&path).is_ok_and(|data| data.is_file());
        match file.then(|| digest(&path)) {
            Some(Ok(found)) if digests.contains(&found) => Owner::Ours,
            _ => Owner::Changed,
        }
    }

    /// Records that a finished temporary file will get this name.
    pub fn claim(&self, name: &str, ready: &Path) -> io::Result<()> {
        let digest = digest(ready)?;
        self.list().written.insert(key(name));
        self.add(&digest, name)
    }

    /// Returns true if this run has written a file.
    pub fn is_of_this_run(&self, name: &str) -> bool {
        self.list().written.contains(&key(name))
    }

    /// Records that a file starts to grow.
    pub fn claim_growing(&self, name: &str) -> io::Result<()> {
        self.add(GROWING, name)
    }

    /// Records that a file has finished growing.
    pub fn end_growing(&self, name: &str) -> io::Result<()> {
        self.add(GROWN, name)
    }

    fn add(&self, what: &str, name: &str) -> io::Result<()> {
        let mut list = self.list();
        let line = format!("{what}  {}", key(name));
        if !list.apply(&line) {
            return Ok(());
        }
        if list.is_open { append(&self.folder.join(LIST_NAME), &line) } else { Ok(()) }
    }

    fn list(&self) -> MutexGuard<'_, List> {
        // The list is consistent between any two changes.
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl List {
    /// Parses the lines of a list.
    fn parse(text: &str) -> Self {
        let mut list = Self::default();
        for line in text.lines().skip(1) {
            list.apply(line);
        }
        list
    }

    /// Applies a line; returns true if it is new.
    fn apply(&mut self, line: &str) -> bool {
        match line.split_once("  ") {
            Some((GROWING, name)) => self.growing.insert(name.to_owned()),
            Some((GROWN, name)) => self.growing.remove(name),
            Some((digest, name)) => self.digests.entry(name.to_owned()).or_default().insert(digest.to_owned()),
            None => false,
        }
    }
}

/// Name in the form of a line.
fn key(name: &str) -> String {
    name.replace('\n', "\\n")
}

/// Appends a line to a list on disk, with the list's first line if it is missing.
fn append(path: &Path, line: &str) -> io::Result<()> {
    let mut file = File::options().append(true).create(true).open(path)?;
    // With several writers, one creates the list. A file system without locks can still be written to.
    let _ = file.lock();
    let text = read_list(path)?;
    let is_partial_header = is_partial_header(&text);
    if is_partial_header && !text.is_empty() {
        // A full disk has truncated the first line.
        file.set_len(0)?;
    }
    // Written in one piece after a line end, so that a truncated line damages no other.
    let head = if is_partial_header { LIST_HEADER } else { "" };
    file.write_all(format!("{head}\n{line}").as_bytes())
}

/// Text of a list; empty without a file.
fn read_list(path: &Path) -> io::Result<String> {
    match fs::metadata(path) {
        Ok(data) if !data.is_file() => Err(io::Error::other("it is not a regular file")),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(String::new()),
        _ => Ok(String::from_utf8_lossy(&fs::read(path)?).into_owned()),
    }
}

fn has_header(text: &str) -> bool {
    text.starts_with(LIST_HEADER)
}

/// Returns true if a list has not got beyond its first line.
fn is_partial_header(text: &str) -> bool {
    text.len() < LIST_HEADER.len() && LIST_HEADER.starts_with(text)
}

fn digest(path: &Path) -> io::Result<String> {
    let mut hash = Sha256::new();
    io::copy(&mut File::open(path)?, &mut hash)?;
    Ok(hexadecimal(&hash.finalize()))
}

fn list_error(folder: &Path, why: &dyn std::fmt::Display) -> Failure {
    let list = folder.join(LIST_NAME);
    Failure::new(format!("cannot read {}, the list of files that joint has written: {why}", list.display()))
        .with_help("name another folder by --out DIR, or move this file elsewhere; it is left as it is")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(folder: &Path) -> OwnFiles {
        let own = OwnFiles::read(folder).expect("no list, or one of ours");
        own.open(Writers::One).expect("room");
        own
    }

    fn owner(folder: &Path, name: &str) -> Owner {
        OwnFiles::read(folder).expect("a list").owner(name)
    }

    #[test]
    fn unchanged_file_is_ours() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a b.csv");
        let own = written(folder.path());
        fs::write(&path, "1").expect("room");
        assert_eq!(own.owner("a b.csv"), Owner::Foreign);
        own.claim("a b.csv", &path).expect("room");
        assert_eq!(owner(folder.path(), "a b.csv"), Owner::Ours);
        fs::write(&path, "2").expect("room");
        assert_eq!(owner(folder.path(), "a b.csv"), Owner::Changed);
    }

    #[test]
    fn growing_file_is_ours() {
        let folder = tempfile::tempdir().expect("a folder");
        let own = written(folder.path());
        own.claim_growing("a.csv").expect("room");
        fs::write(folder.path().join("a.csv"), "1").expect("room");
        assert_eq!(owner(folder.path(), "a.csv"), Owner::Ours);
        own.end_growing("a.csv").expect("room");
        assert_eq!(owner(folder.path(), "a.csv"), Owner::Foreign);
    }

    /// A list cut at any byte keeps its whole lines and accepts more.
    #[test]
    fn truncated_list_keeps_whole_lines() {
        let folder = tempfile::tempdir().expect("a folder");
        let names = ["a", "b", "c"];
        names.iter().for_each(|name| fs::write(folder.path().join(name), name).expect("room"));
        let claim = |name: &str| written(folder.path()).claim(name, &folder.path().join(name)).expect("room");
        claim("a");
        let kept = fs::read(folder.path().join(LIST_NAME)).expect("a list").len();
        claim("b");
        let whole = fs::read(folder.path().join(LIST_NAME)).expect("a list");
        for cut in 0..=whole.len() {
            fs::write(folder.path().join(LIST_NAME), &whole[..cut]).expect("room");
            claim("c");
            let ours = names.map(|name| owner(folder.path(), name) == Owner::Ours);
            assert_eq!(ours, [cut >= kept, cut == whole.len(), true], "cut at {cut}");
        }
    }

    #[test]
    fn list_appears_with_its_first_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let left = || fs::read_dir(folder.path()).expect("a folder").count();
        drop(written(folder.path()));
        assert_eq!(left(), 0, "a run that wrote nothing leaves nothing");
        for killed in [LIST_HEADER, &LIST_HEADER[..20], ""] {
            fs::write(folder.path().join(LIST_NAME), killed).expect("room");
            drop(written(folder.path()));
            assert_eq!(left(), 0, "what was left behind is cleared away");
        }
    }

    #[test]
    fn repeated_entry_is_listed_once() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a"), "1").expect("room");
        let claim = || written(folder.path()).claim("a", &folder.path().join("a")).expect("room");
        claim();
        let before = fs::read(folder.path().join(LIST_NAME)).expect("a list");
        claim();
        assert_eq!(fs::read(folder.path().join(LIST_NAME)).expect("a list"), before);
    }

    #[test]
    fn foreign_list_is_rejected() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join(LIST_NAME), "my thesis").expect("room");
        assert!(OwnFiles::read(folder.path()).is_err());
        assert_eq!(fs::read_to_string(folder.path().join(LIST_NAME)).expect("still there"), "my thesis");
    }
}

//! Files that users name, read whole into memory, but no more of them than a stated size. What is not a regular file is
//! refused before it is opened: a pipe that nobody writes to would be waited for without end. A file goes before what comes
//! with the program under the same name.

use std::collections::BTreeSet;
use std::fs::{self, File, FileType};
use std::io::Read;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::output;

/// A file of this size was not typed by anybody, and named by mistake [bytes].
pub const LARGEST_TYPED: u64 = 1 << 20;
/// A recording may be this large; a larger one is taken for a mistake [bytes].
pub const LARGEST_RECORDED: u64 = 2 << 30;

/// What comes with the program under a name, unless a file has that very name. Where either could be meant, it is said once
/// which one is taken.
pub fn preset<T>(file: &Path, with_name: impl FnOnce(&str) -> Option<T>) -> Option<T> {
    let name = file.to_str()?;
    let found = with_name(name)?;
    let beside = format!("{name}.toml");
    match (file.is_file(), Path::new(&beside).is_file()) {
        (true, _) => say_once(format!("note: `{name}` is the file of that name in this folder, not the preset {name}")),
        (false, true) => {
            say_once(format!(
                "note: `{name}` is the preset of that name, not the file {beside} in this folder: name that ./{beside}"
            ));
        }
        (false, false) => {}
    }
    (!file.is_file()).then_some(found)
}

/// A command may look for one file several times.
fn say_once(remark: String) {
    static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
    if !said.contains(&remark) {
        output::remark(&remark);
        said.insert(remark);
    }
}

/// The bytes of a file, or why they cannot be had.
pub fn bytes(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let read = || {
        if let Some(kind) = not_a_file(fs::metadata(path)?.file_type()) {
            return Ok(Err(kind.to_owned()));
        }
        let file = File::open(path)?;
        let known = file.metadata()?;
        // What the system says beforehand may be nothing, as of a file in /proc, or may have grown meanwhile.
        let mut bytes = Vec::new();
        if known.len() <= largest {
            file.take(largest + 1).read_to_end(&mut bytes)?;
        }
        let fits = known.len() <= largest && bytes.len() as u64 <= largest;
        Ok(if fits { Ok(bytes) } else { Err(format!("it is larger than {}", in_words(largest))) })
    };
    read().unwrap_or_else(|error: std::io::Error| Err(error.to_string()))
}

/// Returns what a path leads to in place of a regular file, and the help.
fn not_a_file(kind: FileType) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return Some("it is a pipe, which may never end: save what it carries to a file, and name that file");
        }
        if kind.is_char_device() || kind.is_block_device() {
            return Some("it is a device, which may never end: save what it gives to a file, and name that file");
        }
        if kind.is_socket() {
            return Some("it is a socket: name a file");
        }
    }
    match (kind.is_file(), kind.is_dir()) {
        (true, _) => None,
        (false, true) => Some("it is a folder"),
        (false, false) => Some("it is not a regular file: name a file"),
    }
}

/// The text of a file, or why it cannot be had.
pub fn text(path: &Path, largest: u64) -> Result<String, String> {
    String::from_utf8(bytes(path, largest)?).map_err(|_| "it is not text (UTF-8)".to_owned())
}

fn in_words(bytes: u64) -> String {
    match (bytes >> 30, bytes >> 20) {
        (0, 0) => format!("{bytes} bytes"),
        (0, mega) => format!("{mega} MB"),
        (giga, _) => format!("{giga} GB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_is_read_than_the_stated_size() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        std::fs::write(&path, "12345678").expect("room");
        assert_eq!(text(&path, 8).as_deref(), Ok("12345678"));
        assert_eq!(text(&path, 7), Err("it is larger than 7 bytes".to_owned()));
        assert_eq!(text(folder.path(), 7), Err("it is a folder".to_owned()));
        std::fs::write(&path, [0xff]).expect("room");
        assert_eq!(text(&path, 7), Err("it is not text (UTF-8)".to_owned()));
        assert!(bytes(&folder.path().join("none"), 7).is_err());
    }

    #[test]
    #[cfg(unix)]
    fn what_is_not_a_regular_file_is_refused_before_it_is_opened() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("`mkfifo` is there");
        assert!(made.success());
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&pipe, &link).expect("room");
        for (path, what) in [(&*pipe, "a pipe"), (&link, "a pipe"), (Path::new("/dev/null"), "a device")] {
            let why = bytes(path, LARGEST_TYPED).expect_err("no file");
            assert!(why.contains(what) && why.contains("name that file"), "{why}");
        }
    }
}

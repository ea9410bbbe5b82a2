//! Reads files that users name, up to a stated size. Anything but a regular file is rejected before it is opened, since
//! a pipe without a writer would block for ever. A file takes precedence over a preset of its name.

use std::collections::BTreeSet;
use std::fs::{self, File, FileType};
use std::io::Read;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::output;

/// Largest file that a person could have typed; a larger one was named by mistake [bytes].
pub const LARGEST_TYPED: u64 = 1 << 20;
/// Largest recording; a larger one was named by mistake [bytes].
pub const LARGEST_RECORDED: u64 = 2 << 30;

/// Preset of a name, unless a file has exactly that name. If both exist, a note states the choice once.
pub fn preset<T>(file: &Path, with_name: impl FnOnce(&str) -> Option<T>) -> Option<T> {
    let name = file.to_str()?;
    let found = with_name(name)?;
    let beside = format!("{name}.toml");
    match (file.is_file(), Path::new(&beside).is_file()) {
        (true, _) => {
            remark_once(format!("note: `{name}` is the file of that name in this folder, not the preset {name}"))
        }
        (false, true) => {
            remark_once(format!(
                "note: `{name}` is the preset of that name, not the file {beside} in this folder: name that ./{beside}"
            ));
        }
        (false, false) => {}
    }
    (!file.is_file()).then_some(found)
}

/// Prints a remark once, though a command may look up a file several times.
fn remark_once(remark: String) {
    static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
    if !said.contains(&remark) {
        output::remark(&remark);
        said.insert(remark);
    }
}

/// Reads a file; the error is the reason.
pub fn bytes(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let read = || {
        if let Some(kind) = special_file(fs::metadata(path)?.file_type()) {
            return Ok(Err(kind.to_owned()));
        }
        let file = File::open(path)?;
        let known = file.metadata()?;
        // The stated size may be 0, as for a file in /proc, or the file may have grown.
        let mut bytes = Vec::new();
        if known.len() <= largest {
            file.take(largest + 1).read_to_end(&mut bytes)?;
        }
        let fits = known.len() <= largest && bytes.len() as u64 <= largest;
        Ok(if fits { Ok(bytes) } else { Err(format!("it is larger than {}", size_in_words(largest))) })
    };
    read().unwrap_or_else(|error: std::io::Error| Err(error.to_string()))
}

/// Returns the kind of a path that is not a regular file, with the remedy.
fn special_file(kind: FileType) -> Option<&'static str> {
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

/// Reads a text file; the error is the reason.
pub fn text(path: &Path, largest: u64) -> Result<String, String> {
    String::from_utf8(bytes(path, largest)?).map_err(|_| "it is not text (UTF-8)".to_owned())
}

fn size_in_words(bytes: u64) -> String {
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
    fn oversized_file_is_rejected() {
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
    fn special_file_is_rejected_unopened() {
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

//! Safe writing: into a temporary file beside the target, then renamed, so that a reader sees the old file or the whole
//! new one.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::interruption::InOrder;

/// Writes a whole file, or leaves the old one as it was.
pub fn write_text(path: &Path, text: &str) -> Outcome<()> {
    write_bytes(path, text.as_bytes())
}

/// The same for what is no text.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Outcome<()> {
    write_with(path, |file| file.write_all(bytes))
}

/// Writes a record as JSON in one line, whole or not at all.
pub fn write_record(path: &Path, record: &impl Serialize) -> Outcome<()> {
    write_with(path, |file| {
        serde_json::to_writer(&mut *file, record)?;
        file.write_all(b"\n")
    })
}

fn write_with(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Outcome<()> {
    let _in_order = InOrder::begin();
    // A link stays a link: what it points to is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let written = match fs::metadata(&target) {
        Ok(there) if there.is_dir() => Err(io::Error::from(ErrorKind::IsADirectory)),
        // A device or a pipe is written to, never replaced.
        Ok(there) if !there.is_file() => {
            File::options().write(true).open(&target).and_then(|file| fill_whole(file, fill).map(drop))
        }
        _ => replace(&target, fill),
    };
    written.map_err(|source| unwritten(path, &source))
}

fn replace(target: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let temporary = temporary_beside(target);
    let written = File::create(&temporary).and_then(|file| {
        // A full disk may only be noticed when the data leave the cache.
        fill_whole(file, fill)?.sync_all()
    });
    written.and_then(|()| fs::rename(&temporary, target)).inspect_err(|_| {
        // The half-written file is of no use to anyone; if it cannot be removed the first error says more.
        let _ = fs::remove_file(&temporary);
    })
}

fn fill_whole(file: File, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<File> {
    let mut buffered = BufWriter::new(file);
    fill(&mut buffered)?;
    buffered.into_inner().map_err(io::IntoInnerError::into_error)
}

/// A name in the same folder, since a rename cannot cross file systems.
fn temporary_beside(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.tmp", std::process::id()));
    path.with_file_name(name)
}

/// Names the file, the system's error and the help.
pub fn unwritten(path: &Path, source: &io::Error) -> Failure {
    let help = match source.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "free some space, or name a path on another disk"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "name a path in a folder that you may write to",
        ErrorKind::NotFound | ErrorKind::NotADirectory => "create its folder first, or name another path",
        ErrorKind::IsADirectory => "this is a folder: name a file in it",
        _ => "name another path",
    };
    Failure::new(format!("cannot write {}: {source}", path.display())).with_help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_named_and_so_is_the_mend() {
        // A short text stays in the buffer: the failure comes only when it is flushed.
        let full = File::options().write(true).open("/dev/full").expect("Linux has a device that is always full");
        let source = fill_whole(full, |file| file.write_all(b"{}")).expect_err("it is full");
        let failure = unwritten(Path::new("out/run.json"), &source);
        assert!(failure.message().contains("out/run.json"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("free some space")), "{failure}");
    }
}

//! Safe writing: into a temporary file beside the target, then renamed, so that a reader sees the old file or the
//! complete new one.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::interruption::UninterruptedWork;

/// Returns true if a path stands for standard output.
pub fn is_standard_output(file: &Path) -> bool {
    file.as_os_str() == "-"
}

/// Writes a complete text file, or leaves the old one unchanged.
pub fn write_text(path: &Path, text: &str) -> Outcome<()> {
    write_bytes(path, text.as_bytes())
}

/// Writes a complete file, or leaves the old one unchanged.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Outcome<()> {
    write_with(path, |_| Ok(()), |file| file.write_all(bytes))
}

/// Writes a record as JSON in one line, completely or not at all.
pub fn write_record(path: &Path, record: &impl Serialize) -> Outcome<()> {
    write_with(path, |_| Ok(()), |file| record_into(file, record))
}

/// Writes a record as JSON in one line.
pub(crate) fn record_into(file: &mut impl Write, record: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *file, record)?;
    file.write_all(b"\n")
}

/// Fills a file, completely or not at all. `ready` receives the path of the complete temporary file just before it is
/// renamed.
pub(crate) fn write_with(
    path: &Path,
    ready: impl FnOnce(&Path) -> io::Result<()>,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Outcome<()> {
    let _uninterrupted = UninterruptedWork::begin();
    // A link stays a link: its target is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let written = match fs::metadata(&target) {
        Ok(there) if there.is_dir() => Err(io::Error::from(ErrorKind::IsADirectory)),
        // A device or a pipe is written to, never replaced.
        Ok(there) if !there.is_file() => {
            File::options().write(true).open(&target).and_then(|file| fill_whole(file, fill).map(drop))
        }
        _ => replace(&target, ready, fill),
    };
    written.map_err(|source| write_failure(path, &source))
}

fn replace(
    target: &Path,
    ready: impl FnOnce(&Path) -> io::Result<()>,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    remove_left_behind(target);
    let temporary = temporary_beside(target);
    let written = File::create(&temporary).and_then(|file| {
        // The lock shows others that the file is in use. A file system without locks can still be written to.
        let _ = file.try_lock();
        // A full disk may only show when the data leave the cache.
        let file = fill_whole(file, fill)?;
        file.sync_all()?;
        ready(&temporary)?;
        fs::rename(&temporary, target)
    });
    written.inspect_err(|_| {
        // The partial file is useless; if it cannot be removed, the first error is more informative.
        let _ = fs::remove_file(&temporary);
    })
}

fn fill_whole(file: File, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<File> {
    let mut buffered = BufWriter::new(file);
    fill(&mut buffered)?;
    buffered.into_inner().map_err(io::IntoInnerError::into_error)
}

/// Tests whether a file could be written beside a target, and leaves no file.
pub(crate) fn try_to_write(target: &Path, bytes: &[u8]) -> io::Result<()> {
    remove_left_behind(target);
    let temporary = temporary_beside(target);
    let tried = File::create(&temporary).and_then(|mut file| file.write_all(bytes));
    let removed = fs::remove_file(&temporary);
    tried.and(removed)
}

/// Attempts to lock a file that another process holds, and the pause between them.
const LOCK_ATTEMPTS: u32 = 20;
const LOCK_PAUSE: Duration = Duration::from_millis(50);

/// Locks a file for this process until it is closed. A process that has just ended may hold the lock a moment longer.
pub fn locked(file: &File) -> bool {
    for _ in 0..LOCK_ATTEMPTS {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(LOCK_PAUSE),
            // A file system without locks can still be written to.
            Ok(()) | Err(TryLockError::Error(_)) => return true,
        }
    }
    false
}

/// Parts of a temporary file's name before and after the process id.
const TEMPORARY: [&str; 2] = [".joint-", ".tmp"];

/// Name in the target's folder, since a rename cannot cross file systems.
fn temporary_beside(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!("{}{}{}", TEMPORARY[0], std::process::id(), TEMPORARY[1]));
    path.with_file_name(name)
}

/// Removes temporary files of a target whose processes were killed. A file that is being written is locked.
fn remove_left_behind(target: &Path) {
    let (Some(folder), Some(name)) = (target.parent(), target.file_name().and_then(|name| name.to_str())) else {
        return;
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let of_target = |found: &str| {
        let process = found.strip_prefix('.')?.strip_prefix(name)?.strip_prefix(TEMPORARY[0])?;
        process.strip_suffix(TEMPORARY[1])?.parse::<u32>().ok()
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().and_then(of_target).is_some()
            && entry.file_type().is_ok_and(|kind| kind.is_file())
        {
            let left = File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
            // A file that cannot be removed does no harm.
            let _ = left.then(|| fs::remove_file(entry.path()));
        }
    }
}

/// Error: a file cannot be written, with the system's error and a remedy.
pub fn write_failure(path: &Path, source: &io::Error) -> Failure {
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

    /// The temporary file of a killed process is removed, that of a running process stays.
    #[test]
    fn only_stale_temporaries_are_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a.json");
        let make = |name: &str| File::create(folder.path().join(name)).expect("room");
        let busy = make(".a.json.joint-2.tmp");
        busy.lock().expect("nobody else has it");
        let names = [".a.json.joint-1.tmp", ".a.json.joint-x.tmp", ".b.json.joint-1.tmp", "a.json.joint-1.tmp"];
        drop(names.map(make));
        write_text(&target, "{}").expect("room");
        let mut left: Vec<_> =
            fs::read_dir(folder.path()).expect("a folder").flatten().map(|e| e.file_name()).collect();
        left.sort();
        assert_eq!(left, [".a.json.joint-2.tmp", names[1], names[2], "a.json", names[3]]);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn full_disk_error_names_remedy() {
        // A short text stays in the buffer: the failure comes only when it is flushed.
        let full = File::options().write(true).open("/dev/full").expect("Linux has a device that is always full");
        let source = fill_whole(full, |file| file.write_all(b"{}")).expect_err("it is full");
        let failure = write_failure(Path::new("out/run.json"), &source);
        assert!(failure.message().contains("out/run.json"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("free some space")), "{failure}");
    }
}

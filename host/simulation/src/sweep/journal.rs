//! Journal of a shard: one line with a checksum for each finished point, written and flushed to the disk at once. A
//! line that a kill or a full disk has truncated is detected and dropped; no other line is ever removed.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use model_core::numbers::digest;

use super::grid::Shard;
use report::failure::{Failure, Outcome};
use report::input;
use report::write::{locked, write_failure};

/// Finished points by number: status and values, as in the result.
pub type Points = BTreeMap<u64, String>;

/// First word of every journal.
const HEAD: &str = "joint-sweep";

/// A journal that is being written.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

/// Name of a shard's journal.
pub fn journal_name(shard: Shard) -> String {
    format!("journal-{}-of-{}.csv", shard.index, shard.count)
}

/// Shard of a journal, by its name.
pub fn shard_of(name: &str) -> Option<Shard> {
    let (index, count) = name.strip_prefix("journal-")?.strip_suffix(".csv")?.split_once("-of-")?;
    let shard = format!("{index}/{count}").parse().ok()?;
    (journal_name(shard) == name).then_some(shard)
}

impl Journal {
    /// Opens a shard's journal to continue it, and removes a truncated last line.
    pub fn open(folder: &Path, shard: Shard, digest: &str) -> Outcome<Self> {
        let path = folder.join(journal_name(shard));
        let failed = |error: io::Error| write_failure(&path, &error);
        let mut file =
            File::options().read(true).write(true).create(true).truncate(false).open(&path).map_err(failed)?;
        if !locked(&file) {
            return Err(Failure::new(format!("{} is being written by another process", path.display()))
                .with_help("let it finish, or end it first; another --shard can run beside it"));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = whole_lines(&bytes);
        check_head(&path, &bytes[..whole], digest)?;
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::Start(whole as u64)).map_err(failed)?;
        let mut journal = Self { path, file };
        if whole == 0 {
            journal.append(&format!("{HEAD},{digest}\n"))?;
        }
        Ok(journal)
    }

    /// Writes lines and flushes them to the disk.
    pub fn append(&mut self, lines: &str) -> Outcome<()> {
        let written = self.file.write_all(lines.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|error| write_failure(&self.path, &error))
    }
}

/// Line of a finished point.
pub fn line(point: u64, result: &str) -> String {
    let text = format!("{point},{result}");
    format!("{text},{:016x}\n", checksum(&text))
}

/// Reads a journal; lines with a wrong checksum are ignored.
pub fn read(path: &Path, digest: &str) -> Outcome<Points> {
    let bytes = input::bytes(path, input::LARGEST_RECORDED).map_err(|why| read_error(path, &why))?;
    let whole = &bytes[..whole_lines(&bytes)];
    check_head(path, whole, digest)?;
    Ok(String::from_utf8_lossy(whole).lines().skip(1).filter_map(parse_line).collect())
}

/// Error: a file of a sweep cannot be read.
pub fn read_error(path: &Path, why: &dyn std::fmt::Display) -> Failure {
    Failure::new(format!("cannot read {}: {why}", path.display()))
        .with_help("see that the folder and its files may be read")
}

/// Number and result in a line with a correct checksum.
fn parse_line(line: &str) -> Option<(u64, String)> {
    let (text, sum) = line.rsplit_once(',')?;
    if sum.len() != 16 || u64::from_str_radix(sum, 16).ok()? != checksum(text) {
        return None;
    }
    let (point, result) = text.split_once(',')?;
    Some((point.parse().ok()?, result.to_owned()))
}

/// Number of bytes up to the end of the last complete line.
fn whole_lines(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1)
}

fn check_head(path: &Path, whole: &[u8], digest: &str) -> Outcome<()> {
    let head = whole.split(|&byte| byte == b'\n').next().unwrap_or_default();
    if whole.is_empty() || head == format!("{HEAD},{digest}").as_bytes() {
        return Ok(());
    }
    let message = match head.starts_with(HEAD.as_bytes()) {
        true => format!("{} belongs to another sweep", path.display()),
        false => format!("{} is not the journal of a sweep", path.display()),
    };
    Err(Failure::new(message).with_help("move it elsewhere, or name another folder by --out DIR; it is left as it is"))
}

fn checksum(text: &str) -> u64 {
    text.bytes().fold(digest::START, |running, byte| digest::chain(running, byte.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIGEST: &str = "feed";

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().expect("a folder")
    }

    fn written(folder: &Path, points: u64) -> PathBuf {
        let mut journal = Journal::open(folder, Shard::WHOLE, DIGEST).expect("a new journal");
        (0..points).for_each(|point| journal.append(&line(point, "ok,1.5,2")).expect("room on the disk"));
        folder.join(journal_name(Shard::WHOLE))
    }

    /// A journal cut at any byte keeps its whole lines and accepts more.
    #[test]
    fn truncated_journal_keeps_whole_lines() {
        let folder = folder();
        let path = written(folder.path(), 5);
        let whole = std::fs::read(&path).expect("a journal");
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).expect("room");
            let kept = read(&path, DIGEST).expect("a journal of this sweep").len();
            let lines = whole[..cut].iter().filter(|byte| **byte == b'\n').count();
            assert_eq!(kept, lines.saturating_sub(1), "cut at {cut}");
            let mut journal = Journal::open(folder.path(), Shard::WHOLE, DIGEST).expect("it goes on");
            journal.append(&line(77, "ok,3,4")).expect("room");
            let points = read(&path, DIGEST).expect("a journal of this sweep");
            assert_eq!(points.len(), kept + 1, "cut at {cut}");
            assert_eq!(points.get(&77).map(String::as_str), Some("ok,3,4"));
        }
    }

    #[test]
    fn altered_journal_line_is_dropped() {
        let folder = folder();
        let path = written(folder.path(), 3);
        let text = std::fs::read_to_string(&path).expect("a journal").replacen("1,ok,1.5", "1,ok,1.6", 1);
        std::fs::write(&path, text).expect("room");
        let points = read(&path, DIGEST).expect("a journal");
        assert_eq!(points.keys().copied().collect::<Vec<_>>(), [0, 2]);
    }

    /// The journal of a different sweep, or a file of any other kind, is an error and stays unchanged.
    #[test]
    fn foreign_journal_is_rejected_unchanged() {
        let folder = folder();
        let path = written(folder.path(), 3);
        let before = std::fs::read(&path).expect("a journal");
        let refused = Journal::open(folder.path(), Shard::WHOLE, "beef").expect_err("another sweep");
        assert!(refused.message().contains("another sweep"), "{refused}");
        assert_eq!(std::fs::read(&path).expect("still there"), before);
        std::fs::write(&path, "my notes\nabout gears\n").expect("room");
        assert!(Journal::open(folder.path(), Shard::WHOLE, DIGEST).is_err());
        assert_eq!(std::fs::read_to_string(&path).expect("still there"), "my notes\nabout gears\n");
    }

    #[test]
    fn journal_has_one_writer() {
        let folder = folder();
        let _held = Journal::open(folder.path(), Shard::WHOLE, DIGEST).expect("a new journal");
        let refused = Journal::open(folder.path(), Shard::WHOLE, DIGEST).expect_err("it is held");
        assert!(refused.message().contains("another process"), "{refused}");
        assert!(Journal::open(folder.path(), Shard { index: 1, count: 2 }, DIGEST).is_ok(), "another shard may");
    }

    #[test]
    fn journal_name_gives_shard() {
        let shard = Shard { index: 3, count: 16 };
        assert_eq!(shard_of(&journal_name(shard)), Some(shard));
        for other in
            ["journal-3-of-2.csv", "journal-x-of-2.csv", "journal-1-of-2.csv.bak", "journal.csv", "journal-01-of-2.csv"]
        {
            assert_eq!(shard_of(other), None, "{other}");
        }
    }
}

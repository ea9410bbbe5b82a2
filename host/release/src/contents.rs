//! Lists of a release: `contents.json` says what each file is, `SHA256SUMS` is for `sha256sum --check`.

use report::digest::sha256;
use report::failure::{Failure, Outcome};
use serde::Serialize;

use crate::source::Source;

/// Name of the list of files.
pub const CONTENTS: &str = "contents.json";
/// Name of the list of digests.
pub const DIGESTS: &str = "SHA256SUMS";

/// File of a release.
#[derive(Debug, Clone)]
pub struct File {
    /// Path in the release, with slashes.
    pub path: String,
    /// Content in one sentence.
    pub what: String,
    /// Machine, processor or board that the file is for.
    pub target: String,
    /// Bytes of the file.
    pub bytes: Vec<u8>,
}

/// Image that cannot be built, with the reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Path that the file would have.
    pub path: String,
    /// Reason.
    pub why: String,
}

/// Line of `contents.json` about a file.
#[derive(Debug, Serialize)]
struct Entry<'f> {
    path: &'f str,
    what: &'f str,
    target: &'f str,
    bytes: usize,
    sha256: String,
}

impl<'f> Entry<'f> {
    fn of_file(file: &'f File) -> Self {
        let File { path, what, target, bytes } = file;
        Self { path, what, target, bytes: bytes.len(), sha256: sha256(bytes) }
    }
}

/// `contents.json`.
#[derive(Debug, Serialize)]
struct Contents<'f> {
    contents_version: u32,
    name: &'static str,
    version: &'static str,
    commit: &'f str,
    commit_date: &'f str,
    compilers: &'f [String],
    files: Vec<Entry<'f>>,
    left_out: &'f [LeftOut],
}

/// Adds the two lists to the files, which are sorted by path.
pub fn add_lists(files: &mut Vec<File>, left_out: &[LeftOut], source: &Source, compilers: &[String]) -> Outcome<()> {
    files.sort_by(|one, other| one.path.cmp(&other.path));
    let contents = Contents {
        contents_version: 1,
        name: "lostmotion",
        version: env!("CARGO_PKG_VERSION"),
        commit: &source.commit,
        commit_date: &source.date,
        compilers,
        files: files.iter().map(Entry::of_file).collect(),
        left_out,
    };
    let bytes = json(&contents)?;
    let list = |path: &str, what: &str, bytes| File {
        path: path.to_owned(),
        what: what.to_owned(),
        target: "any".to_owned(),
        bytes,
    };
    files.push(list(CONTENTS, "list of the files", bytes));
    let digests: String = files.iter().map(|file| format!("{}  {}\n", sha256(&file.bytes), file.path)).collect();
    files.push(list(DIGESTS, "digests of the files", digests.into_bytes()));
    Ok(())
}

/// JSON with a line per value.
pub fn json(value: &impl Serialize) -> Outcome<Vec<u8>> {
    let mut bytes = serde_json::to_vec_pretty(value).map_err(|error| Failure::new(format!("JSON: {error}")))?;
    bytes.push(b'\n');
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::process::Command;

    use super::*;

    fn file(path: &str, bytes: &[u8]) -> File {
        File { path: path.into(), what: "a text".into(), target: "any".into(), bytes: bytes.to_vec() }
    }

    fn lists(mut files: Vec<File>) -> Vec<File> {
        let source = Source { commit: "c0".into(), time: 0, date: "1970-01-01T00:00:00Z".into() };
        let left_out = [LeftOut { path: "images/big.elf".into(), why: "too large".into() }];
        add_lists(&mut files, &left_out, &source, &["rustc 1".into()]).expect("lists");
        files
    }

    /// Order of the files does not matter, and `sha256sum` accepts the list and finds a changed file.
    #[test]
    fn lists_name_every_file_with_its_digest() {
        let files = lists(vec![file("b.txt", b"two"), file("images/a.txt", b"one")]);
        let other = lists(vec![file("images/a.txt", b"one"), file("b.txt", b"two")]);
        assert!(files.iter().zip(&other).all(|(one, other)| one.path == other.path && one.bytes == other.bytes));
        let paths: Vec<&str> = files.iter().map(|file| &*file.path).collect();
        assert_eq!(paths, ["b.txt", "images/a.txt", CONTENTS, DIGESTS]);
        let contents: serde_json::Value = serde_json::from_slice(&files[2].bytes).expect("JSON");
        // SHA-256 of "two" by `sha256sum`.
        let two = "3fc4ccfe745870e2c0d99f71f30ff0656c8dedd41cc1d7d3d376b0dbe685e2f3";
        let expected =
            serde_json::json!({ "path": "b.txt", "what": "a text", "target": "any", "bytes": 3, "sha256": two });
        assert_eq!(contents["files"][0], expected);
        assert_eq!(contents["left_out"][0]["why"], "too large");
        assert_eq!(contents["commit_date"], "1970-01-01T00:00:00Z");

        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("images")).expect("room");
        for file in &files {
            fs::write(folder.path().join(&file.path), &file.bytes).expect("room");
        }
        let check = || {
            let mut command = Command::new("sha256sum");
            command.args(["--check", "--strict", "--quiet", DIGESTS]).current_dir(folder.path());
            command.output().expect("sha256sum").status.success()
        };
        assert!(check());
        fs::write(folder.path().join("images/a.txt"), "One").expect("room");
        assert!(!check());
    }
}

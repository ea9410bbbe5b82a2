//! A result with files: a record as JSON in one line, then the bytes of the files.

use std::fs;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use report::failure::{Failure, Outcome};

/// First line.
#[derive(Debug, Serialize, Deserialize)]
struct Head<R> {
    record: R,
    /// Names and lengths of the files [B].
    files: Vec<(String, usize)>,
}

/// Packs a record, whose numbers must be finite, with files of a folder.
pub fn pack<R: Serialize>(record: &R, folder: &Path, names: Vec<String>) -> Outcome<Vec<u8>> {
    let mut files = Vec::new();
    let mut bodies = Vec::new();
    for name in names {
        let path = folder.join(&name);
        let bytes = fs::read(&path).map_err(|error| {
            Failure::new(format!("cannot read {}: {error}", path.display())).with_help("run the task again")
        })?;
        files.push((name, bytes.len()));
        bodies.extend(bytes);
    }
    let mut packed = serde_json::to_vec(&Head { record, files }).unwrap_or_default();
    packed.push(b'\n');
    packed.extend(bodies);
    Ok(packed)
}

/// A file of a package: name and bytes.
pub type PackedFile = (String, Vec<u8>);

/// Record and files of a package; `None` for other bytes.
pub fn unpack<R: DeserializeOwned>(packed: &[u8]) -> Option<(R, Vec<PackedFile>)> {
    let end = packed.iter().position(|byte| *byte == b'\n')?;
    let Head { record, files } = serde_json::from_slice::<Head<R>>(&packed[..end]).ok()?;
    let mut rest = &packed[end + 1..];
    let mut unpacked = Vec::new();
    for (name, length) in files {
        let (bytes, after) = rest.split_at_checked(length)?;
        unpacked.push((name, bytes.to_vec()));
        rest = after;
    }
    rest.is_empty().then_some((record, unpacked))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn package_keeps_every_bit() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a"), [0, 10, 255]).expect("room");
        fs::write(folder.path().join("b"), "").expect("room");
        let record = vec![0.1 + 0.2, -0.0, f64::MIN_POSITIVE / 3.0, 1e300 / 7.0];
        let packed = pack(&record, folder.path(), vec!["a".to_owned(), "b".to_owned()]).expect("files");
        let (found, files) = unpack::<Vec<f64>>(&packed).expect("a package");
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&found), bits(&record));
        assert_eq!(files, [("a".to_owned(), vec![0, 10, 255]), ("b".to_owned(), Vec::new())]);
        for cut in 0..packed.len() {
            assert!(unpack::<Vec<f64>>(&packed[..cut]).is_none(), "cut at {cut}");
        }
    }
}

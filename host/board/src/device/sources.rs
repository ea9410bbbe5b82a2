//! Decides whether an image is up to date, by one digest over every source file, the compiler and its flags. Cargo
//! alone would rebuild after every change of the joint.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::compile::write_atomically;
use super::toolchain::Toolchain;
use report::digest::{hexadecimal, sha256};
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

/// Folders and files of the workspace that the firmware is built from.
const SOURCES: [&str; 16] = [
    "Cargo.lock",
    "Cargo.toml",
    "memory.x",
    ".cargo",
    "boards",
    "drives",
    "firmware/Cargo.toml",
    "firmware/build.rs",
    "firmware/src",
    "host/board-file",
    "host/joint-file",
    "joints",
    "link",
    "model-core",
    "parameters",
    "virtual-drive",
];

/// Returns the image at `place`, built if it is missing or its digest differs from the one noted beside it.
pub(super) fn up_to_date(
    toolchain: &Toolchain,
    images: &Path,
    place: &Path,
    files: [&Path; 3],
    settings: &str,
    build: impl FnOnce() -> Outcome<Vec<u8>>,
) -> Outcome<Vec<u8>> {
    let texts = files.map(|path| fs::read(path).map_err(|error| Failure::new(format!("{}: {error}", path.display()))));
    let [truth, told, board] = texts;
    let from = digest(toolchain, &[&truth?, &told?, &board?, settings.as_bytes()])?;
    let note = place.with_extension("from");
    let noted = |elf: &[u8]| format!("{from} {}\n", sha256(elf));
    if let Ok(elf) = fs::read(place)
        && fs::read_to_string(&note).is_ok_and(|text| text == noted(&elf))
    {
        return Ok(elf);
    }
    let elf = build()?;
    write_atomically(images, place, &elf)?;
    write_atomically(images, &note, noted(&elf).as_bytes())?;
    Ok(elf)
}

/// Digest over sources, toolchain and further texts, as 64 hexadecimal digits.
fn digest(toolchain: &Toolchain, more: &[&[u8]]) -> Outcome<String> {
    let mut hash = Sha256::new();
    for part in SOURCES {
        let path = workspace().join(part);
        hash_path(&mut hash, &path)
            .map_err(|error| Failure::new(format!("cannot read {}: {error}", path.display())))?;
    }
    for text in [toolchain.compiler().as_bytes(), toolchain.flags().as_bytes()].iter().chain(more) {
        hash.update(text.len().to_le_bytes());
        hash.update(text);
    }
    Ok(hexadecimal(&hash.finalize()))
}

/// Adds a file, or all files of a folder in order of their names.
fn hash_path(hash: &mut Sha256, path: &Path) -> io::Result<()> {
    if path.is_dir() {
        let mut entries: Vec<PathBuf> =
            fs::read_dir(path)?.map(|entry| entry.map(|entry| entry.path())).collect::<io::Result<_>>()?;
        entries.sort();
        return entries.iter().try_for_each(|entry| hash_path(hash, entry));
    }
    let (name, content) = (path.as_os_str().as_encoded_bytes(), fs::read(path)?);
    for bytes in [name, &content] {
        hash.update(bytes.len().to_le_bytes());
        hash.update(bytes);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest_of(folder: &Path) -> Vec<u8> {
        let mut hash = Sha256::new();
        hash_path(&mut hash, folder).expect("readable");
        hash.finalize().to_vec()
    }

    /// The digest changes with every change of a file, and with nothing else.
    #[test]
    fn source_digest_changes_with_files() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("src")).expect("a folder");
        let file = folder.path().join("src/a.rs");
        fs::write(&file, "one").expect("written");
        let before = digest_of(folder.path());
        assert_eq!(digest_of(folder.path()), before);
        fs::write(&file, "two").expect("written");
        let after = digest_of(folder.path());
        assert_ne!(after, before);
        fs::write(folder.path().join("src/b.rs"), "").expect("written");
        assert_ne!(digest_of(folder.path()), after);
    }
}

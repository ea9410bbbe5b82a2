//! ZIP archives without compression and with one fixed date, so that equal contents give equal bytes.
//!
//! Layout: for every file a local header, its name and its bytes; then one central header for each, and the end record.

use report::failure::{Failure, Outcome};

/// Version of the format that a reader needs: 2.0, for folders.
const VERSION: u16 = 20;
/// Maker of the archive: Unix, so that the mode is read.
const MADE_BY: u16 = 3 << 8 | VERSION;
/// Names are UTF-8.
const FLAGS: u16 = 1 << 11;
/// Date of all files: the first one that the format has, 1980-01-01.
const DATE: u16 = 1 << 5 | 1;
/// Regular file that everybody may read.
const MODE: u32 = 0o100_644;

/// File in an archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Path, with slashes.
    pub name: String,
    /// Contents.
    pub bytes: Vec<u8>,
}

impl File {
    /// Text file.
    pub fn text(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), bytes: text.into().into_bytes() }
    }
}

/// Bytes of the archive.
pub fn pack(files: &[File]) -> Outcome<Vec<u8>> {
    let too_large = |_| {
        Failure::new("an archive holds at most 65,535 files and 4 GB")
            .with_help("remove files from the folders of the library's crates that do not belong there")
    };
    let (mut out, mut central) = (vec![], vec![]);
    for file in files {
        let (offset, bytes) =
            (u32::try_from(out.len()).map_err(too_large)?, u32::try_from(file.bytes.len()).map_err(too_large)?);
        let name = u16::try_from(file.name.len()).map_err(too_large)?;
        let mut shared = vec![];
        // Version, flags, method (stored), time, date.
        [VERSION, FLAGS, 0, 0, DATE].iter().for_each(|word| shared.extend(word.to_le_bytes()));
        [crc32fast::hash(&file.bytes), bytes, bytes].iter().for_each(|word| shared.extend(word.to_le_bytes()));
        // Lengths of name and extra field.
        [name, 0].iter().for_each(|word| shared.extend(word.to_le_bytes()));
        out.extend(b"PK\x03\x04");
        out.extend(&shared);
        out.extend(file.name.as_bytes());
        out.extend(&file.bytes);
        central.extend(b"PK\x01\x02");
        central.extend(MADE_BY.to_le_bytes());
        central.extend(&shared);
        // Length of the comment, disk, internal attributes.
        [0_u16; 3].iter().for_each(|word| central.extend(word.to_le_bytes()));
        [MODE << 16, offset].iter().for_each(|word| central.extend(word.to_le_bytes()));
        central.extend(file.name.as_bytes());
    }
    let (count, at, bytes) = (
        u16::try_from(files.len()).map_err(too_large)?,
        u32::try_from(out.len()).map_err(too_large)?,
        u32::try_from(central.len()).map_err(too_large)?,
    );
    out.extend(central);
    out.extend(b"PK\x05\x06");
    // Disks, then the files on this disk and on all.
    [0, 0, count, count].iter().for_each(|word| out.extend(word.to_le_bytes()));
    [bytes, at].iter().for_each(|word| out.extend(word.to_le_bytes()));
    // Length of the comment.
    out.extend([0, 0]);
    Ok(out)
}

//! Archives whose bytes depend on their contents only: no time, no user, an order given by the caller.

use std::io::Cursor;

use report::failure::{Failure, Outcome};

/// Mode of a file that is read.
const READ: u32 = 0o644;
/// Mode of a program.
const RUN: u32 = 0o755;

/// Content of an archive's entry.
#[derive(Debug)]
pub enum Entry {
    /// File to read.
    File(Vec<u8>),
    /// Program to run.
    Program(Vec<u8>),
    /// Symbolic link to another name.
    Link(&'static str),
}

/// Packs named entries below a folder.
pub fn pack(folder: &str, entries: Vec<(String, Entry)>) -> Outcome<Vec<u8>> {
    let mut builder = tar::Builder::new(Vec::new());
    let new_header = |entry: tar::EntryType, mode: u32, size: usize| {
        let mut header = tar::Header::new_ustar();
        header.set_size(size as u64);
        header.set_mode(mode);
        header.set_mtime(0);
        header.set_entry_type(entry);
        header
    };
    for (name, entry) in entries {
        let path = format!("{folder}/{name}");
        let packed = match entry {
            Entry::Link(target) => builder.append_link(&mut new_header(tar::EntryType::Symlink, READ, 0), path, target),
            Entry::File(bytes) => {
                let mut header = new_header(tar::EntryType::Regular, READ, bytes.len());
                builder.append_data(&mut header, path, Cursor::new(bytes))
            }
            Entry::Program(bytes) => {
                let mut header = new_header(tar::EntryType::Regular, RUN, bytes.len());
                builder.append_data(&mut header, path, Cursor::new(bytes))
            }
        };
        packed.map_err(|error| Failure::new(format!("cannot pack {name}: {error}")))?;
    }
    builder.into_inner().map_err(|error| Failure::new(format!("cannot pack {folder}: {error}")))
}

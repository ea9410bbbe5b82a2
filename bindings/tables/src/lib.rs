#![cfg_attr(not(feature = "design"), no_std)]
//! Tables of a joint as constant bytes, with version and digest: written by `joint tables` for a C program, and read in
//! place by `bindings/c`. Tables are not copied: the bytes of a part are those of its struct in memory, laid out as in
//! C, little-endian, padding zero. The same bytes serve every processor with this layout.
//!
//! Layout: a [`Header`], then the parts that it lists, each at a multiple of eight bytes.

#[cfg(feature = "design")]
mod design;
mod fixed;
mod layout;

#[cfg(feature = "design")]
pub use design::{Wanted, design};

use core::mem::offset_of;

use fixed::{Fixed, cast};
use layout::structs;
use model_core::compensation::CompensationTables;
use model_core::gears::Tables;
use model_core::numbers::digest;
use model_core::observer::{ObserverTables, ProbeTable};
use model_core::virtual_joint::SurroundingsTable;
use model_core::wiring::WiringTable;

/// Version of the layout; it must grow with every change of a table's struct (the test `layout` checks).
pub const VERSION: u32 = 5;
/// First bytes of a blob.
const MARK: [u8; 8] = *b"JOINTTAB";
/// Bytes of a joint's name, padded with zeros.
pub const NAME_BYTES: usize = 32;
/// Bytes of a word, the alignment of blob and parts.
const WORD: usize = 8;
/// Number of kinds of parts.
const PARTS: usize = 6;

/// Place of a part.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Part {
    /// Offset from the beginning of the blob [B].
    pub offset: u32,
    /// Size; zero if the part is missing [B].
    pub bytes: u32,
}

/// Beginning of a blob.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Header {
    /// Mark `JOINTTAB`.
    mark: [u8; 8],
    /// Version of the layout.
    pub version: u32,
    /// Size of the whole blob [B].
    pub bytes: u32,
    /// Digest over every other word of the blob.
    pub digest: u64,
    /// Name of the joint.
    pub name: [u8; NAME_BYTES],
    /// Control rate [Hz].
    pub control_rate: u32,
    /// Tick rate of the samples' clock [Hz].
    pub clock_rate: u32,
    /// Bandwidth that the compensation is designed for [rad/s].
    pub bandwidth: f32,
    /// Number of planets of the plant; zero without a plant.
    pub planets: u32,
    /// Gears, surroundings, observer, probe, compensation, wiring check.
    parts: [Part; PARTS],
}

structs! {
    Part { offset, bytes }
    Header { mark, version, bytes, digest, name, control_rate, clock_rate, bandwidth, planets, parts }
}

/// Bytes before the parts.
const HEADER_BYTES: usize = size_of::<Header>();
const _: () = assert!(HEADER_BYTES.is_multiple_of(WORD) && align_of::<Header>() == WORD);
/// Index of the word that holds the digest.
const DIGEST_AT: usize = offset_of!(Header, digest) / WORD;

/// Reason for which tables are rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlobError {
    /// The mark is missing.
    NotTables,
    /// Another version of the layout.
    WrongVersion,
    /// The size differs from the stated one.
    WrongSize,
    /// The digest does not match.
    Damaged,
    /// The part is missing.
    Missing,
}

/// Checked tables.
#[derive(Debug, Clone, Copy)]
pub struct Blob<'a> {
    words: &'a [u64],
    header: &'a Header,
}

/// Tables of a plant, by its number of planets.
#[derive(Debug, Clone, Copy)]
pub enum Gears<'a> {
    /// Equivalent gear.
    One(&'a Tables<f32, 1>),
    /// Three planets.
    Three(&'a Tables<f32, 3>),
    /// Four planets.
    Four(&'a Tables<f32, 4>),
    /// Five planets.
    Five(&'a Tables<f32, 5>),
}

impl<'a> Blob<'a> {
    /// Opens tables with the right mark, version, size and digest.
    pub fn open(words: &'a [u64]) -> Result<Self, BlobError> {
        let (head, _) = words.split_at_checked(HEADER_BYTES / WORD).ok_or(BlobError::NotTables)?;
        let header: &Header = cast(head).ok_or(BlobError::NotTables)?;
        if header.mark != MARK {
            return Err(BlobError::NotTables);
        }
        if header.version != VERSION {
            return Err(BlobError::WrongVersion);
        }
        if header.bytes as usize != WORD * words.len() {
            return Err(BlobError::WrongSize);
        }
        if header.digest != digest_of(words) {
            return Err(BlobError::Damaged);
        }
        Ok(Self { words, header })
    }

    /// Header of the tables.
    pub fn header(&self) -> &'a Header {
        self.header
    }

    /// Tables of the observer.
    pub fn observer(&self) -> Result<&'a ObserverTables<f32>, BlobError> {
        self.part(2)
    }

    /// Table of the width probe.
    pub fn probe(&self) -> Result<&'a ProbeTable<f32>, BlobError> {
        self.part(3)
    }

    /// Tables of the compensation.
    pub fn compensation(&self) -> Result<&'a CompensationTables<f32>, BlobError> {
        self.part(4)
    }

    /// Table of the wiring check.
    pub fn wiring(&self) -> Result<&'a WiringTable<f32>, BlobError> {
        self.part(5)
    }

    /// Tables of the plant.
    pub fn plant(&self) -> Result<(Gears<'a>, &'a SurroundingsTable<f32>), BlobError> {
        let gears = match self.header.planets {
            1 => Gears::One(self.part(0)?),
            3 => Gears::Three(self.part(0)?),
            4 => Gears::Four(self.part(0)?),
            5 => Gears::Five(self.part(0)?),
            _ => return Err(BlobError::Missing),
        };
        Ok((gears, self.part(1)?))
    }

    fn part<T: Fixed>(&self, kind: usize) -> Result<&'a T, BlobError> {
        let Part { offset, bytes } = self.header.parts.get(kind).copied().unwrap_or_default();
        if bytes == 0 {
            return Err(BlobError::Missing);
        }
        let (begin, length) = (offset as usize / WORD, bytes as usize / WORD);
        let words = self.words.get(begin..).and_then(|rest| rest.get(..length));
        words.and_then(cast).ok_or(BlobError::Damaged)
    }
}

fn digest_of(words: &[u64]) -> u64 {
    let [before, after] = match words.split_at_checked(DIGEST_AT) {
        Some((before, [_, after @ ..])) => [before, after],
        _ => [words, &[]],
    };
    before.iter().chain(after).fold(digest::START, |running, word| digest::chain(running, *word))
}

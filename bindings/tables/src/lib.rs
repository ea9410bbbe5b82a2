#![cfg_attr(not(feature = "design"), no_std)]
//! The tables of a joint as constant bytes, with version and digest: what `joint tables` writes for a C program, and what
//! `bindings/c` reads where it lies. Tables are not copied: the bytes of a part are those of its struct in memory, which the
//! language lays out as C does, little-endian, padding zero. The same bytes serve every processor of that kind.
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

/// Version of the layout: the next one as soon as a struct of a table changes (the test `layout` tells).
pub const VERSION: u32 = 5;
/// How a blob begins.
const MARK: [u8; 8] = *b"JOINTTAB";
/// Bytes of a joint's name, zeros after its end.
pub const NAME_BYTES: usize = 32;
/// Bytes of a word: what blob and parts are aligned to.
const WORD: usize = 8;
/// Kinds of parts.
const PARTS: usize = 6;

/// Where a part is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Part {
    /// From the beginning of the blob [B].
    pub offset: u32,
    /// Zero where there is none [B].
    pub bytes: u32,
}

/// What a blob begins with.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Header {
    /// `JOINTTAB`.
    mark: [u8; 8],
    /// Of the layout.
    pub version: u32,
    /// Of the whole blob.
    pub bytes: u32,
    /// Over every other word of the blob.
    pub digest: u64,
    /// The joint.
    pub name: [u8; NAME_BYTES],
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Ticks of the samples' clock in a second [Hz].
    pub clock_rate: u32,
    /// Bandwidth that the compensation is designed for [rad/s].
    pub bandwidth: f32,
    /// Planets of the plant; zero without a plant.
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
/// The word that holds the digest.
const DIGEST_AT: usize = offset_of!(Header, digest) / WORD;

/// Why tables are not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlobError {
    /// They do not begin as tables do.
    NotTables,
    /// They are of another version of the layout.
    WrongVersion,
    /// There are fewer or more bytes than they say.
    WrongSize,
    /// The digest does not fit.
    Damaged,
    /// This part is not among them.
    Missing,
}

/// Tables that were found sound.
#[derive(Debug, Clone, Copy)]
pub struct Blob<'a> {
    words: &'a [u64],
    header: &'a Header,
}

/// A plant's tables, by its number of planets.
#[derive(Debug, Clone, Copy)]
pub enum Gears<'a> {
    /// An equivalent gear.
    One(&'a Tables<f32, 1>),
    /// Three planets.
    Three(&'a Tables<f32, 3>),
    /// Four.
    Four(&'a Tables<f32, 4>),
    /// Five.
    Five(&'a Tables<f32, 5>),
}

impl<'a> Blob<'a> {
    /// Takes tables if mark, version, size and digest are right.
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

    /// What they begin with.
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

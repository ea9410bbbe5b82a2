//! Mutations of text and binary files. A mutation is data, so that the smallest failing one can be reported.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// Critical numbers as a user may type them.
pub const CRITICAL_NUMBERS: [&str; 15] = [
    "1e300",
    "-1e300",
    "1e5",
    "1e7",
    "1e-300",
    "-1",
    "0",
    "NaN",
    "inf",
    "1e999",
    "9223372036854775807",
    "4294967295",
    "65536",
    "",
    "x",
];
/// Critical numbers as bytes.
const CRITICAL_INTEGERS: [u64; 8] = [0, 1, 0x7f, 0xffff, u32::MAX as u64, 1 << 40, u64::MAX, u64::MAX / 2];
/// Delimiters, opening and unmatched, and odd characters.
const DELIMITERS: [&str; 12] =
    ["[", "]", "[[fault]]\n", "\"", "#", "\n", ",", "=", "uint8[0] n\n", "\u{feff}", "[4294967295]", "\0"];
/// Repetitions of a piece.
const REPETITIONS: std::ops::Range<usize> = 1..20_000;

/// One mutation.
#[derive(Debug, Clone)]
pub enum Mutation {
    /// Replaces a typed number.
    Number(Index, &'static str),
    /// Flips bits of a byte.
    Bits(Index, u8),
    /// Overwrites some bytes with a whole number.
    Integer(Index, u64, usize),
    /// Removes a part.
    Remove(Index, Index),
    /// Cuts the file off.
    CutOff(Index),
    /// Repeats a part.
    Repeat(Index, Index, usize),
    /// Inserts a piece, repeated.
    Piece(Index, &'static str, usize),
}

/// A few mutations in sequence.
pub fn mutations() -> impl Strategy<Value = Vec<Mutation>> {
    let place = any::<Index>;
    let one = prop_oneof![
        12 => (place(), select(&CRITICAL_NUMBERS[..])).prop_map(|(place, typed)| Mutation::Number(place, typed)),
        3 => (place(), 1_u8..).prop_map(|(place, bits)| Mutation::Bits(place, bits)),
        6 => (place(), select(&CRITICAL_INTEGERS[..]), select(&[2_usize, 4, 8][..]))
            .prop_map(|(place, number, size)| Mutation::Integer(place, number, size)),
        1 => (place(), place()).prop_map(|(from, to)| Mutation::Remove(from, to)),
        1 => place().prop_map(Mutation::CutOff),
        2 => (place(), place(), 1..40_usize).prop_map(|(from, to, times)| Mutation::Repeat(from, to, times)),
        3 => (place(), select(&DELIMITERS[..]), REPETITIONS)
            .prop_map(|(place, piece, times)| Mutation::Piece(place, piece, times)),
    ];
    vec(one, 1..4)
}

/// Mutated copy of a file.
pub fn mutated(valid: &[u8], changes: &[Mutation]) -> Vec<u8> {
    changes.iter().fold(valid.to_vec(), |bytes, change| change.apply(bytes))
}

impl Mutation {
    fn apply(&self, mut bytes: Vec<u8>) -> Vec<u8> {
        if bytes.is_empty() {
            return bytes;
        }
        let at = |place: &Index, bytes: &[u8]| place.index(bytes.len());
        let range = |from: &Index, to: &Index, bytes: &[u8]| {
            let (from, to) = (at(from, bytes), at(to, bytes));
            from.min(to)..from.max(to)
        };
        match self {
            Self::Number(place, typed) => {
                let places = numbers(&bytes);
                if !places.is_empty() {
                    bytes.splice(places[place.index(places.len())].clone(), typed.bytes());
                }
            }
            Self::Bits(place, bits) => {
                let place = at(place, &bytes);
                bytes[place] ^= bits;
            }
            Self::Integer(place, number, size) => {
                let from = at(place, &bytes);
                let to = (from + size).min(bytes.len());
                bytes.splice(from..to, number.to_le_bytes()[..*size].iter().copied());
            }
            Self::Remove(from, to) => {
                let range = range(from, to, &bytes);
                bytes.drain(range);
            }
            Self::CutOff(place) => {
                let place = at(place, &bytes);
                bytes.truncate(place);
            }
            Self::Repeat(from, to, times) => {
                let range = range(from, to, &bytes);
                let (end, part) = (range.end, bytes[range].repeat(*times));
                bytes.splice(end..end, part);
            }
            Self::Piece(place, piece, times) => {
                let place = at(place, &bytes);
                bytes.splice(place..place, piece.repeat(*times).into_bytes());
            }
        }
        bytes
    }
}

/// Places of typed numbers in a text.
fn numbers(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let part = |byte: &u8| byte.is_ascii_digit() || b".-+eE".contains(byte);
    let mut places = Vec::new();
    let mut from = 0;
    for word in bytes.split(|byte| !part(byte)) {
        if word.iter().any(u8::is_ascii_digit) {
            places.push(from..from + word.len());
        }
        from += word.len() + 1;
    }
    places
}

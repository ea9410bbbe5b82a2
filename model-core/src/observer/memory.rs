//! Saved parameters of an observer, as bytes. Saving and loading happen outside the tick; loading rejects memories that
//! are damaged, of another version or of another joint.
//!
//! Layout, little-endian: mark, version, number of parameters, identity of joint and encoders, encoder zeros at the
//! start, parameters, factors of their covariance, bias and friction with their covariance, mobility of the link with
//! its variance, digest of all bytes before.

use core::fmt;

use super::learnt::Learnt;
use super::tables::ObserverTables;
use crate::numbers::{Real, digest};

/// Size of a memory [bytes].
pub const MEMORY_BYTES: usize = 544;

/// Serialized parameters.
pub type Memory = [u8; MEMORY_BYTES];

const MARK: u32 = u32::from_le_bytes(*b"JOBS");
const VERSION: u16 = 3;
const DIGEST_AT: usize = MEMORY_BYTES - 8;
/// Bytes before the parameters.
const HEAD: usize = 24;

/// Reason for rejecting a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MemoryError {
    /// Not a memory of an observer, or incomplete.
    NotAMemory,
    /// Written by another version.
    WrongVersion,
    /// Digest mismatch: bytes were lost or changed.
    Damaged,
    /// Belongs to another joint, other encoders or an observer with another number of parameters.
    OtherJoint,
    /// Contains NaN, or a number that no joint of this design can have.
    OutOfRange,
}

impl fmt::Display for MemoryError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NotAMemory => "this is no memory of an observer: save one first",
            Self::WrongVersion => "the memory is of another version of the observer: let it learn again and save anew",
            Self::Damaged => "the memory is damaged: load a copy, or let the observer learn again",
            Self::OtherJoint => "the memory belongs to another joint or to other encoders: load this joint's own",
            Self::OutOfRange => {
                "the memory holds a number that no joint of this design can have: let the observer learn again and \
                 save anew"
            }
        })
    }
}

impl core::error::Error for MemoryError {}

/// Serializes the estimated parameters; `start` is the position of the encoders' zeros in units of their difference.
pub(super) fn save<T: Real, const P: usize>(tables: &ObserverTables<T>, start: i64, learnt: &Learnt<T, P>) -> Memory {
    let mut memory = [0; MEMORY_BYTES];
    let mut writer = Writer { bytes: memory.iter_mut() };
    writer.put(&MARK.to_le_bytes());
    writer.put(&VERSION.to_le_bytes());
    writer.put(&(P as u16).to_le_bytes());
    writer.put(&tables.identity.to_le_bytes());
    writer.put(&start.to_le_bytes());
    let numbers = learnt.learner.numbers().chain(learnt.bias.numbers()).chain(learnt.inertia.numbers());
    numbers.for_each(|number| writer.number(number));
    let digest = digest_of(&memory);
    if let Some(place) = memory.get_mut(DIGEST_AT..) {
        place.copy_from_slice(&digest.to_le_bytes());
    }
    memory
}

/// Restores saved parameters and returns the position of the encoders' zeros. A rejected memory changes nothing.
pub(super) fn load<T: Real, const P: usize>(
    memory: &[u8],
    tables: &ObserverTables<T>,
    learnt: &mut Learnt<T, P>,
) -> Result<i64, MemoryError> {
    let mut reader = Reader { bytes: memory };
    let (mark, version) = (reader.take().map(u32::from_le_bytes), reader.take().map(u16::from_le_bytes));
    if memory.len() != MEMORY_BYTES || mark != Some(MARK) {
        return Err(MemoryError::NotAMemory);
    }
    if version != Some(VERSION) {
        return Err(MemoryError::WrongVersion);
    }
    let stored = memory.get(DIGEST_AT..).and_then(|bytes| bytes.try_into().ok()).map(u64::from_le_bytes);
    if stored != Some(digest_of(memory)) {
        return Err(MemoryError::Damaged);
    }
    let parameters = reader.take().map(u16::from_le_bytes);
    let identity = reader.take().map(u64::from_le_bytes);
    let start = reader.take().map(i64::from_le_bytes).unwrap_or(0);
    if parameters != Some(P as u16) || identity != Some(tables.identity) {
        return Err(MemoryError::OtherJoint);
    }
    let (mut learner, mut bias, mut inertia) = (learnt.learner, learnt.bias, learnt.inertia);
    let mut next = || reader.number();
    learner.set_numbers(&mut next);
    bias.set_numbers(&mut next);
    inertia.set_numbers(&mut next);
    // NaN fails every range check.
    if !(learner.is_possible(tables) && bias.is_possible(&tables.contact) && inertia.is_possible(&tables.inertia)) {
        return Err(MemoryError::OutOfRange);
    }
    // Pending samples were evaluated with the old parameters and are discarded.
    learnt.interrupt();
    learnt.learner = learner;
    learnt.bias = bias;
    learnt.inertia = inertia;
    Ok(start)
}

/// Numbers of a memory in order: parameters, covariance factors column by column down to the diagonal, bias and
/// friction with variances and covariance, mobility and its variance. [`Observer::load`](super::Observer::load) checks
/// their ranges.
///
/// ```
/// use model_core::observer::design::{design_observer, observer_settings};
/// use model_core::observer::{MAPPED, Observer, memory_numbers};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let tables = design_observer(&q1.parameters, &observer_settings(&q1.surroundings))?;
/// let memory = Observer::<f32, MAPPED>::new(&tables).save();
/// // The first is half of the gap along the gap coordinate, twice the half-backlash of a mesh: as designed, here.
/// assert_eq!(memory_numbers(&memory).next(), Some(80e-6));
/// assert!(memory_numbers(&memory).take(MAPPED).all(f32::is_finite));
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
pub fn memory_numbers(memory: &Memory) -> impl Iterator<Item = f32> {
    let (numbers, _) = memory.get(HEAD..).unwrap_or_default().as_chunks();
    numbers.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

/// Digest of all bytes before the digest.
fn digest_of(memory: &[u8]) -> u64 {
    memory.iter().take(DIGEST_AT).fold(digest::START, |running, byte| digest::chain(running, (*byte).into()))
}

struct Writer<'memory> {
    bytes: core::slice::IterMut<'memory, u8>,
}

impl Writer<'_> {
    fn put(&mut self, bytes: &[u8]) {
        bytes.iter().zip(self.bytes.by_ref()).for_each(|(byte, place)| *place = *byte);
    }

    /// Not inlined, like the reader's counterpart: more than a hundred calls, outside the tick.
    #[inline(never)]
    fn number<T: Real>(&mut self, number: T) {
        self.put(&(number.to_f64() as f32).to_le_bytes());
    }
}

struct Reader<'memory> {
    bytes: &'memory [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*taken)
    }

    #[inline(never)]
    fn number<T: Real>(&mut self) -> T {
        T::from_f64(f32::from_le_bytes(self.take().unwrap_or_default()).into())
    }
}

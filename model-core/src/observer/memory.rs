//! Saved parameters of an observer, as bytes. Saving and loading happen outside the tick; loading rejects memories that
//! are damaged, of another version or of another joint.
//!
//! Layout, little-endian: mark, version, number of parameters, identity of joint and encoders, encoder zeros at the
//! start, parameters, factors of their covariance, bias and friction with their covariance, mobility of the link with
//! its variance, digest of all bytes before.

use core::fmt;

use super::identification::ParameterEstimator;
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
pub(super) fn save<T: Real, const P: usize>(
    tables: &ObserverTables<T>,
    start: i64,
    estimator: &ParameterEstimator<T, P>,
) -> Memory {
    let mut memory = [0; MEMORY_BYTES];
    let mut writer = Writer { bytes: memory.iter_mut() };
    writer.write_bytes(&MARK.to_le_bytes());
    writer.write_bytes(&VERSION.to_le_bytes());
    writer.write_bytes(&(P as u16).to_le_bytes());
    writer.write_bytes(&tables.identity.to_le_bytes());
    writer.write_bytes(&start.to_le_bytes());
    let saved_numbers = estimator
        .least_squares
        .saved_numbers()
        .chain(estimator.bias.saved_numbers())
        .chain(estimator.inertia.saved_numbers());
    saved_numbers.for_each(|number| writer.write_number(number));
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
    estimator: &mut ParameterEstimator<T, P>,
) -> Result<i64, MemoryError> {
    let mut reader = Reader { bytes: memory };
    let (mark, version) = (reader.read_bytes().map(u32::from_le_bytes), reader.read_bytes().map(u16::from_le_bytes));
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
    let parameters = reader.read_bytes().map(u16::from_le_bytes);
    let identity = reader.read_bytes().map(u64::from_le_bytes);
    let start = reader.read_bytes().map(i64::from_le_bytes).unwrap_or(0);
    if parameters != Some(P as u16) || identity != Some(tables.identity) {
        return Err(MemoryError::OtherJoint);
    }
    let (mut least_squares, mut bias, mut inertia) = (estimator.least_squares, estimator.bias, estimator.inertia);
    let mut next_number = || reader.read_number();
    least_squares.restore_numbers(&mut next_number);
    bias.restore_numbers(&mut next_number);
    inertia.restore_numbers(&mut next_number);
    // NaN fails every range check.
    if !(least_squares.is_in_range(tables) && bias.is_in_range(&tables.contact) && inertia.is_in_range(&tables.inertia))
    {
        return Err(MemoryError::OutOfRange);
    }
    // Pending samples were evaluated with the old parameters and are discarded.
    estimator.discard_interval();
    estimator.least_squares = least_squares;
    estimator.bias = bias;
    estimator.inertia = inertia;
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
    let (saved_numbers, _) = memory.get(HEAD..).unwrap_or_default().as_chunks();
    saved_numbers.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

/// Digest of all bytes before the digest.
fn digest_of(memory: &[u8]) -> u64 {
    memory.iter().take(DIGEST_AT).fold(digest::START, |running, byte| digest::chain(running, (*byte).into()))
}

struct Writer<'memory> {
    bytes: core::slice::IterMut<'memory, u8>,
}

impl Writer<'_> {
    fn write_bytes(&mut self, bytes: &[u8]) {
        bytes.iter().zip(self.bytes.by_ref()).for_each(|(byte, place)| *place = *byte);
    }

    /// Not inlined, like the reader's counterpart: more than a hundred calls, outside the tick.
    #[inline(never)]
    fn write_number<T: Real>(&mut self, number: T) {
        self.write_bytes(&(number.to_f64() as f32).to_le_bytes());
    }
}

struct Reader<'memory> {
    bytes: &'memory [u8],
}

impl Reader<'_> {
    fn read_bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (disturbance_torque, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*disturbance_torque)
    }

    #[inline(never)]
    fn read_number<T: Real>(&mut self) -> T {
        T::from_f64(f32::from_le_bytes(self.read_bytes().unwrap_or_default()).into())
    }
}
